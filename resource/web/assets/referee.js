// The page of a referee, judge or organiser on a phone, tablet or laptop (docs/web.md, "Referees").

import {address, clockText, html, parameters, useEffect, useRef, useState} from "/assets/parts.js";
import {render} from "/assets/vendor/preact-htm.js";
import {Live} from "/assets/live.js";
import {ask, reasonsText, roleText} from "/assets/device.js";
import {Marks, Stop, send, signal} from "/assets/commands.js";
import {Command, Hold, Twice} from "/assets/buttons.js";
import {Correction} from "/assets/correction.js";
import {HeadReferee, JudgeRun, Publication} from "/assets/judging.js";
import {ADD, RefusedMark, Sheet} from "/assets/sheet.js";

const SILENT_S = 2.2;
const ASK_AGAIN_MS = 1500;
const SOON = 1;
const SWITCHES = 10;
const STILL_MS = 400;
const LOOK_MS = 250;
const SLEPT_MS = 1000;

const language = parameters.get("language") || "";
const state = {session: undefined, live: null, known: null, stop: null, said: "", place: "", marks: null, tick: null};

function draw() {
  render(html`<${Page} />`, document.getElementById("page"));
}

// -- the connection -----------------------------------------------------------------------------------

async function begin() {
  const answer = await ask("GET", "session");
  if (answer.status === 200) {
    state.session = answer.body;
    open(answer.body.zone || parameters.get("zone") || "");
  } else if (answer.status === 401) {
    state.session = null;
    if (state.live) {
      state.live.close();
    }
    openWords();
  } else {
    setTimeout(begin, ASK_AGAIN_MS);
  }
}

function open(zone) {
  if (zone !== state.zone) {
    state.known = null;
  }
  state.zone = zone;
  if (state.live) {
    state.live.close();
  }
  const query = {language: language || navigator.languages.join(",")};
  if (zone) {
    query.zone = zone;
  }
  state.live = new Live("device", query, changed, SILENT_S);
  window.live = state.live;  // for the browser's console, and for tests
  state.marks.isLinked = () => state.live.silentSince === null;
}

// A page that is not paired still needs its texts.
function openWords() {
  state.live = new Live("events", {documents: "page.words,page.device_words", language: language || navigator.languages.join(",")},
    draw);
}

// The zone. A gateway that was just started does not know it yet: then it is as it was last known, so STOP stays possible.
function zoneNow() {
  state.known = state.live.data["page.zone"] || (state.live.silentSince !== null && state.known) || null;
  return state.known;
}

function changed(names = []) {
  if (names.length === 1 && names[0] === "page.clock" && state.tick) {
    state.tick();  // comes each second, and drawing the whole page takes long on a slow phone
    return;
  }
  if (names.length === 0 && state.session) {
    check();
  }
  const zone = zoneNow(), zones = state.live.data["page.zones"];
  if (!state.zone && !zone && zones && zones.length > 0) {
    open(zones[0].zone);  // an organiser, and the gateway did not know the zones before
    return;
  }
  if (zone && state.live.silentSince === null) {
    const place = [zone.event, zone.identity, zone.phase].join();
    state.said = place === state.place ? state.said : "";  // why it was refused is no news any more
    state.place = place;
    if (state.stop && state.stop.state !== "sending" && zone.phase !== "running") {
      state.stop = null;  // what the box answered is no news any more
    }
    state.marks.again();
  }
  draw();
}

// The pairing may have been ended while the page was open, or another one made in another tab.
async function check() {
  const answer = await ask("GET", "session");
  const isOther = answer.status === 200 && state.session && answer.body.id !== state.session.id;
  if (state.session && (answer.status === 401 || isOther)) {
    begin();
  }
}
setInterval(() => state.session && state.live.silentSince !== null && check(), 2 * ASK_AGAIN_MS);

// While a phone or laptop sleeps, the clock of its pages may be stopped, so they notice no silence.
let slept = Date.now() - performance.now();
setInterval(() => {
  const now = Date.now() - performance.now();
  if (Math.abs(now - slept) > SLEPT_MS && state.session && state.live) {
    state.live.wake();
  }
  slept = now;
}, LOOK_MS);
window.addEventListener("offline", () => state.live && state.live.socket && state.live.reconnect(state.live.socket));

// -- commands -----------------------------------------------------------------------------------------

async function give(name, texts, label, more = {}) {
  const zone = zoneNow();
  const answered = send(name, {zone: zone.zone, ...more});  // first: a slow phone takes long to draw
  state.said = `${label} …`;
  draw();
  const answer = await answered;
  state.said = answer.status === 200 ? "" : texts.refused.replace("{what}", () => label)
    .replace("{reasons}", () => reasonsText(answer, texts));
  draw();
  return answer.status === 200;
}

function stopRun(zone) {
  if (state.stop && state.stop.state === "sending" && state.stop.identity === zone.identity) {
    return;
  }
  repeatStop(new Stop(zone.zone, zone.identity, draw));
  signal(660, [150]);  // after it is sent: the first sound takes long on a phone
}

function repeatStop(stop) {
  state.stop = stop;
  stop.repeat();
}

async function undo(last, texts) {
  if (last.change === ADD) {
    state.marks.takeOff(last);
  } else if (await give("take_back", texts, texts.undo.replace("{mark}", () => last.shown),
    {identity: last.identity, id: last.id})) {
    state.marks.forget(last);
  }
}

// -- parts --------------------------------------------------------------------------------------------

function Figure({figure, isMain}) {
  return html`
    <div class="figure ${isMain ? "first" : ""} ${figure.hurry ? "hurry" : ""}">
      <span class="label">${figure.label}</span> <span class="time">${figure.text}</span>
    </div>`;
}

function Run({zone, texts}) {
  const [, redraw] = useState(0);
  const clock = state.live.data["page.clock"];
  useEffect(() => {
    state.tick = () => redraw((before) => before + 1);
    return () => (state.tick = null);
  }, []);
  useSignals(zone, clock);
  return html`
    <section class="run ${zone.phase}">
      <h1 class="team">${zone.team}</h1>
      <p class="title">${zone.title}</p>
      <p class="facts">${zone.facts}</p>
      <p class="phase"><span class="unseen">${texts.state}: </span>${zone.phase_text}${zone.robot && ` · ${zone.robot}`}</p>
      ${clock && html`
        <div class="times">
          ${clock.pause && html`<p class="pause">${clock.pause}</p>`}
          <${Figure} figure=${clock.main} isMain />
          ${clock.goal && html`<${Figure} figure=${clock.goal} />`}
          ${clock.aside && html`<p class="facts">${clock.aside}</p>`}
        </div>`}
      <p class="todo ${zone.is_urgent ? "urgent" : ""}" role="status">${zone.todo}</p>
      <ul class="state">${zone.state.map((line) => html`<li>${line}</li>`)}</ul>
    </section>`;
}

function Operation({zone, texts}) {
  const [typed, setTyped] = useState("");
  const {operation} = zone;
  const answer = (text) => give("operation", texts, texts.operation, {operation: operation.number, answer: text});
  return html`
    <section class="operation">
      <h2>${texts.operation}</h2>
      <p class="todo urgent">${operation.text}</p>
      ${operation.choices.map((choice) => html`<${Command} label=${choice} act=${() => answer(choice)} />`)}
      ${operation.choices.length === 0 && html`<${Command} label=${texts.done} act=${() => answer(typed)} isMain />`}
      ${operation.asks_text && html`
        <label>${texts.answer}<input maxlength="200" value=${typed} onInput=${(event) => setTyped(event.target.value)} /></label>
        <${Command} label=${texts.save} act=${() => answer(typed)} />`}
    </section>`;
}

function Switches({zone, texts}) {
  const {on, damaged, to_confirm} = zone.switches;
  const numbers = Array.from({length: SWITCHES}, (_, i) => i + 1);
  return html`
    <section class="switches">
      <h2>${texts.switches}</h2>
      <div class="controls">
        ${numbers.map((number) => html`
          <button type="button" aria-pressed=${on.includes(number)}
              onClick=${() => give("switch", texts, String(number), {number})}>
            ${number}: ${on.includes(number) ? texts.is_on : texts.is_off}
          </button>`)}
      </div>
      <p>${texts.damaged}: ${damaged}</p>
      <div class="controls">
        <button type="button" disabled=${damaged === 0}
            onClick=${() => give("damaged", texts, texts.damaged, {number: damaged - 1})}>−1</button>
        <button type="button" onClick=${() => give("damaged", texts, texts.damaged, {number: damaged + 1})}>+1</button>
      </div>
      ${to_confirm && html`<${Command} label=${texts.confirm} act=${() => give("confirm_switches", texts, texts.confirm)} isMain />`}
    </section>`;
}

function Commands({zone, texts}) {
  const next = {idle: "connect", connected: "start", ended: "leave"}[zone.phase];
  const button = (name) => html`
    <${Command} name=${name} label=${texts[name]} reasons=${zone.off[name]} isMain=${name === next}
      act=${() => give(name, texts, texts[name])} />`;
  const twice = (name, more = {}) => html`
    <${Twice} key="${name} ${zone.event} ${zone.identity}" name=${name} label=${texts[name]} question=${texts.really}
      reasons=${zone.off[name]} act=${() => give(name, texts, texts[name], more)} isMain=${name === next} />`;
  return html`
    <section class="commands">
      <h2>${texts.commands}</h2>
      <div class="grid">
        ${zone.phase === "idle" && button("connect")}
        ${zone.robots.map((robot) => html`
          <${Command} label=${texts.connect_robot.replace("{robot}", () => robot)}
            act=${() => give("connect_robot", texts, robot, {robot})} />`)}
        ${["idle", "connected"].includes(zone.phase) && button("start")}
        ${zone.phase === "ended" && twice("start")}
        ${["connected", "ended"].includes(zone.phase) && html`
          <${Twice} key="leave ${zone.identity}" name="leave" label=${texts.leave} question=${texts.really} reasons=${zone.off.leave}
            isMain=${next === "leave"} act=${() => give("leave", texts, texts.leave, {identity: zone.identity})} />`}
        ${zone.has_pause && (zone.off.resume.length === 0 ? button("resume") : button("pause"))}
        ${zone.has_phases && [button("previous_phase"), button("next_phase")]}
      </div>
      <details>
        <summary>${texts.more}</summary>
        <div class="grid">
          ${twice("previous")}${twice("next")}
          ${twice("open_sheet")}${twice("no_show")}${twice("withdrawn")}
        </div>
      </details>
    </section>`;
}

function Reason({zone, texts}) {
  const [typed, setTyped] = useState("");
  const [saved, setSaved] = useState("");
  const save = async (event) => {
    event.preventDefault();
    if (await give("stop_reason", texts, texts.stop_reason, {identity: zone.identity, reason: typed})) {
      setSaved(typed);
    }
  };
  return html`
    <form class="reason" onSubmit=${save}>
      <label>${texts.stop_reason}
        <input maxlength="200" value=${typed} onInput=${(event) => setTyped(event.target.value)} /></label>
      <button>${texts.save}</button>
      ${saved && html`<p role="status">${texts.saved}: ${saved}</p>`}
    </form>`;
}

function Unsigned({zone, texts}) {
  return zone.unsigned.length > 0 && html`
    <section class="unsigned">
      <h2>${texts.unsigned}</h2>
      <ul>${zone.unsigned.map((run) => html`
        <li key=${run.identity}>
          <p><strong>${run.title}</strong></p>
          <p>${run.end}${run.score && ` · ${run.score}`}</p>
          ${zone.judging.some((one) => one.identity === run.identity && one.count > 0) || html`
            <${Correction} zone=${zone} run=${run} marks=${state.marks} texts=${texts} undo=${(last) => undo(last, texts)} />`}
          <${Twice} name="sign_off" label=${texts.sign_off} question=${texts.really}
            reasons=${state.marks.waiting.some((mark) => mark.identity === run.identity) ? [texts.marks_wait] : []}
            act=${() => give("sign_off", texts, texts.sign_off, {identity: run.identity})} />
          ${zone.judging.filter((one) => one.identity === run.identity && one.count === 0).map((one) => html`
            <${Publication} zone=${zone.zone} run=${one} texts=${texts} give=${give} />`)}
        </li>`)}</ul>
    </section>`;
}

function Zones({zones, zone, texts}) {
  const choose = (event) => {
    parameters.set("zone", event.target.value);
    history.replaceState(null, "", `${location.pathname}?${parameters}`);
    open(event.target.value);
    draw();
  };
  return html`
    <label class="zones">${texts.zone}
      <select onChange=${choose}>
        ${zones.map((one) => html`<option value=${one.zone} selected=${one.zone === zone}>
          ${one.zone} · ${one.team} · ${one.phase}</option>`)}
      </select>
    </label>`;
}

// Signals for the ear and the hand: 30 s and 10 s before the end, and the end.
function useSignals(zone, clock) {
  const before = useRef({});
  useEffect(() => {
    const now = {identity: zone && zone.identity, phase: zone && zone.phase, hurry: clock ? clock.main.hurry : 0};
    const was = before.current;
    before.current = now;
    if (!zone || was.identity !== now.identity) {
      return;
    }
    if (was.phase === "running" && now.phase === "ended") {
      signal(440, [600, 150, 600]);
    } else if (now.phase === "running" && now.hurry >= SOON && was.hurry < now.hurry) {
      signal(550, [200]);
    }
  });
}

// What moved under the finger must not be hit: a button that is new, was moved or got another text does nothing for a moment.
const places = new WeakMap();
function keepStill() {
  for (const button of document.querySelectorAll(".all button")) {
    const {left, top} = button.getBoundingClientRect();
    const place = [Math.round(left + scrollX), Math.round(top + scrollY), button.textContent].join();
    const before = places.get(button);
    if (!before || before.place !== place) {
      clearTimeout(before && before.timer);
      button.dataset.moved = "moved";
      places.set(button, {place, timer: setTimeout(() => delete button.dataset.moved, STILL_MS)});
    }
  }
}
// Whatever drew it: a part of the page may draw itself, such as a sheet that was asked for.
new MutationObserver(keepStill).observe(document.getElementById("page"), {subtree: true, childList: true, characterData: true});

// The bar is at the bottom of what is seen: a keyboard on the screen, or a page that is enlarged, leaves less.
function keepInSight() {
  const {height, offsetTop} = visualViewport;
  document.documentElement.style.setProperty("--covered", `${Math.max(0, innerHeight - height - offsetTop)}px`);
}
["resize", "scroll"].forEach((kind) => visualViewport.addEventListener(kind, keepInSight));

// What became of STOP; empty: nothing is to be said. `zone`: the one that is shown.
function stopText(zone, texts) {
  const {stop} = state;
  if (!stop) {
    return "";
  }
  const isShown = zone && stop.zone === zone.zone;
  const text = {
    sending: texts.stopping.replace("{n}", () => stop.tries),
    confirmed: isShown && stop.identity === zone.identity && zone.phase === "running" ? texts.stopped : "",
    refused: texts.not_stopped.replace("{reasons}", () => stop.isPaired ? stop.reasons.join("; ") : texts.not_paired),
  }[stop.state];
  return text && !isShown ? `${stop.zone}: ${text}` : text;
}

function StopBar({zone, texts, isOld}) {
  const reasons = zone && !isOld ? zone.off.stop : [];
  const said = stopText(zone, texts);
  return html`
    <footer class="stopbar">
      ${said && html`<p class=${state.stop.state === "confirmed" ? "good" : "alarm"} role="alert">${said}</p>`}
      ${reasons.length > 0 ? html`<p class="why"><strong>${texts.stop}</strong>: ${reasons.join("; ")}</p>` : html`
        <${Hold} label=${texts.stop} hint=${texts.hold_to_stop} data-command="stop" disabled=${!zone}
          act=${() => stopRun(zone)} />`}
    </footer>`;
}

function Page() {
  const {live, session, marks} = state;
  const data = live ? live.data : {};
  const words = data["page.words"], texts = data["page.device_words"];
  const zone = live && zoneNow();
  if (!words || session === undefined) {
    return null;
  }
  document.documentElement.lang = words.language;
  document.title = zone ? `${zone.zone} – ${texts.referee_page}` : texts.referee_page;
  if (session === null) {
    const stopped = stopText(null, texts);
    return html`
      ${stopped && html`<p class="alarm" role="alert">${stopped}</p>`}
      <h1 class="title">${texts.not_paired}</h1>
      <p class="nothing">${texts.pair_how}</p>
      <p><a class="button main" href=${address("/pair")}>${texts.pair_title}</a></p>`;
  }
  const isOld = live.silentSince !== null || !zone;
  document.body.classList.toggle("old", isOld);
  const judge = session.role === "judge" ? session.person : "";
  const isJudged = Boolean(zone) && zone.judging.some((run) => run.identity === zone.identity && run.count > 0);
  const last = zone && marks.last(zone.identity);
  const isOther = (mark) => !zone || (mark.identity !== zone.identity
    && !zone.judging.some((run) => run.identity === mark.identity && run.count > 0));
  return html`
    ${isOld && html`<p class="alarm" role="alert">${live.silentSince === null ? (zone ? texts.offline_now : words.waiting)
      : texts.offline.replace("{time}", () => clockText(live.silentSince, words))}</p>`}
    <header class="who">
      ${session.zone ? html`<strong>${session.zone}</strong>` : data["page.zones"] && html`
        <${Zones} zones=${data["page.zones"]} zone=${zone && zone.zone} texts=${texts} />`}
      ${session.role === "organiser" && html`<a href=${address("/displays")}>${texts.displays}</a>`}
      <a href=${address("/pair")}>${session.person} · ${roleText(session, texts)}</a>
    </header>
    ${zone && html`
      ${zone.warnings.length > 0 && html`
        <section class="warnings"><h2>${texts.warnings}</h2>
          <ul>${zone.warnings.map((text) => html`<li>⚠ ${text}</li>`)}</ul></section>`}
      <${Run} zone=${zone} texts=${texts} />
      <p class="said" role="status">${state.said}</p>
      ${marks.refused.filter(isOther).map((mark) => html`<${RefusedMark} mark=${mark} marks=${marks} texts=${texts} />`)}
      <fieldset disabled=${isOld} class="all">
        ${!judge && html`
          ${zone.operation && html`<${Operation} key="${zone.identity} ${zone.operation.number}" zone=${zone} texts=${texts} />`}
          ${zone.switches && html`<${Switches} zone=${zone} texts=${texts} />`}
          ${zone.phase === "running" || html`<${Commands} zone=${zone} texts=${texts} />`}
          ${zone.phase === "ended" && html`<${Reason} key=${zone.identity} zone=${zone} texts=${texts} />`}`}
        ${zone.judging.filter((run) => run.count > 0).map((run) => judge ? html`
          <${JudgeRun} key=${run.identity} zone=${zone.zone} run=${run} marks=${marks} texts=${texts} person=${judge} give=${give} />` : html`
          <${HeadReferee} key=${run.identity} zone=${zone.zone} run=${run} texts=${texts} give=${give} />`)}
        ${isJudged && !judge && html`<p class="nothing">${texts.judges_score}</p>`}
        ${zone.items.length > 0 && !isJudged && html`<${Sheet} key=${zone.identity} zone=${zone} marks=${marks} texts=${texts} judge=${judge} />`}
        ${last && html`<${Command} name="undo" label=${texts.undo.replace("{mark}", () => last.shown)} act=${() => undo(last, texts)} />`}
        ${!judge && zone.phase === "running" && html`<${Commands} zone=${zone} texts=${texts} />`}
        ${marks.waiting.filter(isOther).map((mark) => html`<p class="alarm" role="status">${texts.not_confirmed.replace("{mark}",
          () => `${mark.desc}: ${mark.shown}`)}</p>`)}
        ${!judge && html`<${Unsigned} zone=${zone} texts=${texts} />`}
      </fieldset>`}
    ${!judge && html`<${StopBar} zone=${zone} texts=${texts} isOld=${isOld} />`}`;
}

state.marks = new Marks(draw);
window.marks = state.marks;
const unfinished = Stop.unfinished(draw);
if (unfinished) {
  repeatStop(unfinished);
}
begin();
