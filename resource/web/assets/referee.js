// The page of a referee, judge or organiser on a phone, tablet or laptop (docs/web.md, "Referees").

import {Component, address, html, parameters, useEffect, useRef, useState} from "/assets/parts.js";
import {render} from "/assets/vendor/preact-htm.js";
import {Live} from "/assets/live.js";
import {ask, reasonsText, roleText} from "/assets/device.js";
import {Marks, nameOf, send} from "/assets/commands.js";
import {Cells, Command, Twice} from "/assets/buttons.js";
import {Keys, listen} from "/assets/keys.js";
import {drop, keep, kept} from "/assets/kept.js";
import {lockWhenIdle} from "/assets/lock.js";
import {Missing, stayAwake} from "/assets/phone.js";
import {Nav, Part, isSent, partsOf} from "/assets/box.js";
import {HeadReferee, JudgeRun} from "/assets/judging.js";
import {FinishedRun} from "/assets/runs.js";
import {RefusedMark, Sheet} from "/assets/sheet.js";

const SILENT_S = 2.2;
const ASK_AGAIN_MS = 1500;
const SOON = 1;
const SWITCHES = 10;
const CHANGED_MS = 600;
const SHOWN = "shown", KEPT_MS = 2000;

const language = parameters.get("language") || "";
const place = document.getElementById("page");
const {strip} = window;  // STOP: see stop.js
const IS_BOX = location.pathname === "/box";  // the page of the whole box: with parts, of which one is open
const OWN = "zone";  // the part that the referee's page consists of
const state = {session: undefined, live: null, known: null, said: "", place: "", marks: null, tick: null, isChoosing: false,
  part: IS_BOX ? parameters.get("part") || "overview" : OWN,
  shown: "",  // the zone that was shown last
  gone: "",  // that a zone is gone, until the reader touches the page
  isEnded: false};  // the box was ended here, and is not heard again yet

function draw() {
  render(html`<${Guard} name="page"><${Page} /><//>`, place);
}

// A part of the page that fails says so in its place. The others work, and the next update tries it again.
class Guard extends Component {
  componentDidCatch(error) {
    strip.failed(this.props.name, error);
    this.isTried = true;
    this.setState({error});
  }
  componentWillReceiveProps() {
    this.setState({error: null});
  }
  componentDidUpdate() {
    this.state.error || this.isTried || strip.works(this.props.name);
    this.isTried = false;
  }
  render({name, children}, {error}) {
    return error ? html`<p class="failed" role="alert">⚠ ${name}: ${String(error.message || error)}</p>` : children;
  }
}

// -- the connection -----------------------------------------------------------------------------------

async function begin() {
  const answer = await ask("GET", "session");
  if (answer.status === 200) {
    const isOpen = state.live && state.session && state.session.id === answer.body.id;
    state.session = answer.body;
    strip.pair(true);
    if (isOpen) {  // as it was kept
      return;
    }
    state.part = partsOf(answer.body).includes(state.part) ? state.part : OWN;
    open(answer.body.zone || parameters.get("zone") || "");
  } else if (answer.status === 401) {
    state.session = null;
    strip.pair(false);
    if (state.live) {
      state.live.close();
    }
    drop(SHOWN, location.pathname).catch(() => {});
    openWords();
  } else {
    setTimeout(begin, ASK_AGAIN_MS);
    state.session === undefined && openKept();
  }
}

// Without a link, the page begins with what it has shown last.
async function openKept() {
  const shown = (await kept(SHOWN).catch(() => [])).find(({path}) => path === location.pathname);
  if (shown && state.session === undefined) {
    state.session = shown.session;
    open(shown.zone, shown.data);
    changed(Object.keys(shown.data));
  }
}

// Notes what is shown, but not each second.
function keepShown() {
  state.keeping = state.keeping || setTimeout(() => {
    state.keeping = null;
    const {session, zone, live} = state;
    const data = Object.fromEntries(Object.entries(live.data).filter(([name]) => !name.startsWith("part.")));
    session && keep(SHOWN, location.pathname, {path: location.pathname, session, zone, data}).catch(() => {});
  }, KEPT_MS);
}

function open(zone, known = null) {
  if (zone !== state.zone) {
    state.known = null;
  }
  state.zone = state.shown = zone;
  strip.show(zone);
  if (state.live) {
    state.live.close();
  }
  state.live = new Live("device", query(), changed, SILENT_S, known);
  window.live = state.live;  // for the browser's console, and for tests
  state.marks.isLinked = () => state.live.silentSince === null;
}

const query = () => ({language: language || navigator.languages.join(","), ...(state.zone && {zone: state.zone}),
  ...(isSent(state.part) && {part: state.part})});

// Another part: its document is sent from now on, and that of the part before is not.
function openPart(part) {
  delete state.live.data[`part.${state.part}`];
  state.part = part;
  parameters.set("part", part);
  history.replaceState(history.state, "", `${location.pathname}?${parameters}`);
  scrollTo(0, 0);
  state.live.reopen(query());
  draw();
}

// A page that is not paired still needs its texts.
function openWords() {
  state.live = new Live("events", {documents: "page.words,page.device_words", language: language || navigator.languages.join(",")}, () => {
    speak(state.live.data["page.device_words"]);
    draw();
  });
}

const speak = (texts) => texts && strip.speak(texts, whyNoStop);

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
    state.isEnded = state.isEnded && state.live.silentSince !== null;
  }
  const zone = zoneNow(), zones = state.live.data["page.zones"], texts = state.live.data["page.device_words"];
  speak(texts);
  stayAwake(isRunning());
  state.session && state.live.silentSince === null && keepShown();
  if (zone) {
    state.shown = zone.zone;
    strip.show(zone.zone);
  }
  if (zones && zones.some((one) => one && one.zone === state.goneZone)) {
    state.gone = state.goneZone = "";
  }
  if (isGone(zones) && !state.session.zone) {
    const known = zones.map((one) => one.zone), other = known.includes(strip.other()) ? strip.other() : known[0];
    state.goneZone = state.shown;
    state.gone = texts ? texts.zone_gone.replace("{zone}", () => state.shown).replace("{other}", () => other) : "";
    openZone(other);
    return;
  }
  if (!state.zone && !zone && zones && zones.length > 0) {
    open(zones[0].zone);  // an organiser, and the gateway did not know the zones before
    return;
  }
  if (zone && state.live.silentSince === null) {
    const now = [zone.event, zone.identity, zone.phase].join();
    state.said = now === state.place ? state.said : "";  // why it was refused is no news any more
    state.place = now;
    state.marks.again();
  }
  draw();
}

// Whether the zone that was shown is not in the schedule: `reload` may have removed it.
function isGone(zones) {
  return Boolean(state.session && state.shown && zones && zones.length > 0) && state.live.silentSince === null
    && zones.every((one) => one && one.zone !== state.shown);
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

window.addEventListener("wake", () => state.session && state.live && state.live.wake());
window.addEventListener("offline", () => state.live && state.live.socket && state.live.reconnect(state.live.socket));

// -- commands -----------------------------------------------------------------------------------------

async function give(name, texts, label, more = {}) {
  const zone = zoneNow();
  if (state.live.silentSince !== null) {  // nothing but marks waits for a link
    state.said = texts.not_current;
    draw();
    return false;
  }
  const answered = send(name, {zone: zone.zone, ...more});  // first: a slow phone takes long to draw
  state.said = `${label} …`;
  draw();
  const answer = await answered;
  state.said = answer.status === 200 ? "" : texts.refused.replace("{what}", () => label)
    .replace("{reasons}", () => reasonsText(answer, texts));
  answer.status === 200 || strip.signal(330, [80, 80, 80]);
  draw();
  return answer.status === 200;
}

// What goes with an action: what is shown, and the values of its fields. A team is the one that is shown.
function shownOf(zone, name, action, given = {}) {
  const shown = {team: () => zone.team, fixed: (field) => field.default, confirmed: () => Boolean(zone.questions[name])};
  const filled = action.fields.filter(({kind}) => FILLED.includes(kind)).map((field) => [field.name, shown[field.kind](field)]);
  return {identity: zone.identity, event_id: action.aims ? zone.event_id : "", given: {...Object.fromEntries(filled), ...given}};
}

// Why the box does not let STOP be pressed in a zone, and whether a robot may be moving there.
function whyNoStop(name) {
  const zone = state.live && state.live.data["page.zone"];
  return zone && zone.zone === name ? [zone.off.stop.join("; "), isMoving(zone)] : null;
}

// Whether a robot did not answer STOP.
const isMoving = (zone) => Boolean(zone.leaving) && zone.is_urgent;

const undo = (last, texts) => state.marks.undo(last, texts.undo.replace("{mark}", () => last.shown));

// -- parts --------------------------------------------------------------------------------------------

function Figure({figure, isMain}) {
  return html`
    <div class="figure ${isMain ? "first" : ""} ${figure && figure.hurry ? "hurry" : ""}">
      ${figure && html`<span class="label">${figure.label}</span> <span class="time">${figure.text}</span>`}
    </div>`;
}

// Each line has its place, also while there is nothing to say: what moved under a finger would be hit by mistake.
function Run({zone, texts}) {
  const [, redraw] = useState(0);
  const clock = state.live.data["page.clock"];
  useEffect(() => {
    state.tick = () => redraw((before) => before + 1);
    return () => (state.tick = null);
  }, []);
  useSignals(zone, clock);
  const {main = null, goal = null, pause = "", aside = ""} = clock || {};
  return html`
    <section class="run ${zone.phase}">
      <h1 class="team short">${zone.team}</h1>
      <p class="title short">${zone.title}</p>
      <p class="facts short">${zone.facts}</p>
      <p class="phase short"><span class="unseen">${texts.state}: </span>${[zone.phase_text, zone.robot].filter(Boolean).join(" · ")}</p>
      <div class="times">
        <${Figure} figure=${main} isMain />
        <${Figure} figure=${goal} />
        <p class="short ${pause ? "pause" : "facts"}">${pause || aside}</p>
      </div>
    </section>`;
}

// What the referee must do and know now. It scrolls in a place that keeps its size. Controls come first, where nothing
// moves them. When a line changes, all lines are new ones: so none moves.
function Now({zone, texts, judge}) {
  const {marks} = state;
  const late = waitingText(marks, texts);
  const asked = judge ? [] : offered(zone, texts).filter(([, {row}]) => row === "module");
  return html`
    <section class="now ${asked.length > 0 ? "operation" : ""}" tabindex="0" aria-label=${texts.state}>
      ${asked.map(([name, action]) => html`
        <div class="asks" key="${zone.identity} ${JSON.stringify([name, action.fields])}">
          <${Form} command=${oneOf(zone, texts, name, {isMain: true})} action=${action} zone=${zone} texts=${texts} />
        </div>`)}
      ${!judge && zone.robots.length > 0 && html`<div class="controls">${zone.robots.map((robot) => html`
        <${zone.questions.connect ? Twice : Command} key=${robot} label=${texts.connect_robot.replace("{robot}", () => robot)}
          question=${texts.really} act=${() => give("connect", texts, robot, shownOf(zone, "connect", texts.actions.connect, {robot}))} />`)}</div>`}
      ${marks.refused.map((mark) => html`<${RefusedMark} key=${mark.id} mark=${mark} marks=${marks} texts=${texts} />`)}
      <div role="status" key=${JSON.stringify([late, asked, zone.todo, zone.warnings, zone.state])}>
        ${late && html`<p class="alarm">${late}</p>`}
        ${asked.length === 0 && html`<p class="todo ${zone.is_urgent ? "urgent" : ""}">${zone.todo}</p>`}
        <ul class="warnings">${zone.warnings.map((text) => html`<li>⚠ ${text}</li>`)}</ul>
        <ul class="state">${zone.state.map((line) => html`<li>${line}</li>`)}</ul>
      </div>
    </section>`;
}

// What waits, in a line: the oldest that is late, and how many there are.
function waitingText(marks, texts) {
  const late = marks.waiting.find((mark) => mark.isLate);
  return !late ? "" : [lateText(late, texts), marks.waiting.length > 1 && texts.queued.replace("{number}", () => marks.waiting.length),
    !marks.isKept && texts.not_kept].filter(Boolean).join(" · ");
}

const lateText = (mark, texts) => (mark.isAtBox ? texts.not_on_disks : texts.not_confirmed).replace("{mark}", () => nameOf(mark));
const refusedText = (mark, texts) => texts.refused.replace("{what}", () => nameOf(mark))
  .replace("{reasons}", () => mark.reasons.join("; "));

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

// Commands that this page lays out itself, beside those that most runs do not need. All others are shown in a row that the
// table of actions names, with a form if somebody must enter something.
const PLACED = ["connect", "start", "disconnect", "stop", "switch", "damaged", "confirm_switches"];
const ENTERED = ["name", "text", "number", "decimal", "pose", "choice", "toggle"];
const FILLED = ["team", "fixed", "confirmed"];
// How what is measured is typed.
const HINTS = {pose: "x y ° (1.25 0.40 90)", decimal: "0.5"};

const isForm = ([, {fields}]) => fields.some(({kind}) => ENTERED.includes(kind));

// The actions without a place of their own, with their fields as they are now.
function offered(zone, texts) {
  return Object.entries(texts.actions).map(([name, action]) => [name, {...action, fields: zone.fields[name] || action.fields}])
    .filter(([name, {fields}]) => !PLACED.includes(name) && name in zone.off && zone.shown[name]
      && fields.every(({kind}) => [...ENTERED, ...FILLED].includes(kind)));
}

function oneOf(zone, texts, name, more = {}) {
  const action = texts.actions[name];
  return {
    name, label: action.label, question: texts.really, reasons: zone.off[name] || [],
    isTwice: action.careful || Boolean(zone.questions[name]), of: `${zone.event} ${zone.identity}`,
    warning: action.leaves && isMoving(zone) ? zone.leaving : "",
    act: () => give(name, texts, action.label, shownOf(zone, name, action)), ...more,
  };
}

function Commands({zone, texts}) {
  const next = zone.leaving || zone.questions.connect ? "" : {idle: "connect", connected: "start", ended: "disconnect"}[zone.phase];
  const one = (name, more = {}) => oneOf(zone, texts, name, {isMain: name === next, ...more});
  const others = offered(zone, texts).filter(([, {row}]) => row !== "module");
  const cells = (row) => others.filter((other) => other[1].row === row && !isForm(other)).map(([name]) => one(name));
  return html`
    <section class="commands">
      <${Cells} commands=${[
        one("connect"),
        zone.phase === "ended" ? one("start", {isTwice: true, of: "again", label: texts.continue}) : one("start"),
        one("disconnect"),
        ...cells("clock"),
      ]} />
      <details>
        <summary class="short">${texts.more}</summary>
        <${Cells} commands=${cells("more")} />
      </details>
      ${others.filter(isForm).map(([name, action]) => html`
        <details key=${name}>
          <summary class="short">${action.label}</summary>
          <${Form} key="${zone.event} ${zone.identity}" command=${one(name)} action=${action} zone=${zone} texts=${texts} />
        </details>`)}
      <details>
        <summary class="short">${texts.stop_reason}</summary>
        <${Reason} key=${zone.identity} zone=${zone} texts=${texts} />
      </details>
      <${Keys} texts=${texts} />
      <${Missing} texts=${texts} />
    </section>`;
}

// The fields of an action, and what a module asks the referee to do. One choice is a button for each answer.
function Form({command, action, zone, texts}) {
  const [given, setGiven] = useState({});
  const fields = action.fields.filter(({kind}) => ENTERED.includes(kind));
  const set = (name, value) => setGiven((before) => ({...before, [name]: value}));
  const isMissing = fields.some(({name, required, kind}) => required && kind !== "toggle" && !String(given[name] === undefined ? "" : given[name]).trim());
  const toggles = fields.filter(({kind}) => kind === "toggle").map(({name}) => [name, false]);
  const act = async (more) => {
    if (await give(command.name, texts, action.label, shownOf(zone, command.name, action, {...Object.fromEntries(toggles), ...given, ...more}))) {
      setGiven({});
    }
  };
  const text = zone.texts[command.name];
  const explained = html`<p class=${text ? "asked" : "facts"} role=${text && "alert"}>${text ? `☞ ${text}` : action.explanation}</p>`;
  if (fields.length === 1 && fields[0].kind === "choice") {
    const [{name, choices}] = fields;
    return html`
      <div class="form">
        ${explained}
        <div class="controls">${choices.map((choice) => html`<${Command} key=${choice} label=${choice}
          reasons=${command.reasons} act=${() => act({[name]: choice})} />`)}</div>
      </div>`;
  }
  return html`
    <div class="form">
      ${explained}
      ${fields.map((field) => html`
        <label key=${field.name}>${field.label}${field.unit ? ` (${field.unit})` : ""}
          <${Input} field=${field} value=${given[field.name]} set=${(value) => set(field.name, value)} /></label>`)}
      <div class="controls"><${Command} name=${command.name} label=${action.label} isMain=${command.isMain} act=${() => act()}
        reasons=${command.reasons.length > 0 || !isMissing ? command.reasons : [texts.fill_in]} /></div>
    </div>`;
}

function Input({field, value, set}) {
  if (field.kind === "toggle") {
    return html`<input type="checkbox" checked=${Boolean(value)} onChange=${(event) => set(event.target.checked)} />`;
  }
  if (field.kind === "choice") {
    return html`<select value=${value || ""} onChange=${(event) => set(event.target.value)}>
      ${["", ...field.choices].map((choice) => html`<option key=${choice} value=${choice}>${choice}</option>`)}</select>`;
  }
  if (field.kind === "number") {
    return html`<input type="number" inputmode=${field.low < 0 ? "text" : "numeric"} min=${field.low} max=${field.high} value=${value === undefined ? "" : value}
      onInput=${(event) => set(event.target.value === "" ? undefined : Math.trunc(Number(event.target.value)))} />`;
  }
  return html`<input placeholder=${HINTS[field.kind]} maxlength=${field.characters || 200} value=${value || ""} onInput=${(event) => set(event.target.value)} />`;
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
      <button disabled=${zone.phase !== "ended"}>${texts.save}</button>
      ${saved && html`<p role="status">${texts.saved}: ${saved}</p>`}
    </form>`;
}

// The runs that are over: their sheets, their judges, their results. It is closed until the referee opens it: so it
// moves nothing during a run.
function Over({zone, texts}) {
  const judged = zone.judging.filter((run) => run.count > 0);
  const identities = new Set([...judged, ...zone.unsigned].map((run) => run.identity));
  const differences = judged.reduce((sum, run) => sum + run.differences, 0);
  return html`
    <details class="over">
      <summary class="short">${texts.unsigned}: ${identities.size + zone.unlisted}${differences > 0
        && ` · ⚠ ${texts.differences.replace("{number}", () => differences)}`}</summary>
      ${judged.map((run) => html`
        <${HeadReferee} key=${run.identity} zone=${zone.zone} run=${run} texts=${texts} give=${give} />`)}
      <ul class="unsigned">${zone.unsigned.map((run) => html`
        <${FinishedRun} key=${run.identity} zone=${zone} run=${run} marks=${state.marks} texts=${texts} give=${give}
          undo=${(last) => undo(last, texts)} />`)}</ul>
      ${zone.unlisted > 0 && html`<p class="facts">${texts.hidden.replace("{number}", () => zone.unlisted)}</p>`}
    </details>`;
}

function choose(isChoosing) {
  state.isChoosing = isChoosing;
  draw();
}

function openZone(name) {
  parameters.set("zone", name);
  history.replaceState(history.state, "", `${location.pathname}?${parameters}`);
  open(name);
  choose(false);
}

// A part of a zone, such as its own: commands, score sheet.
function openInZone(name, part = OWN) {
  state.part = part;
  parameters.set("part", part);
  openZone(name || state.zone);
}

// The box ends.
function ended() {
  state.isEnded = true;
  draw();
}

function Header({zone, zones, session, texts}) {
  const name = session.zone || (zone && zone.zone) || "";
  return html`
    <header class="who">
      ${session.zone || !zones ? html`<strong class="short">${name}</strong>` : html`
        <button type="button" class="short zones" aria-expanded=${state.isChoosing} aria-label="${texts.zone}: ${name}"
          onClick=${() => choose(!state.isChoosing)}>${name} ▾</button>`}
      ${!IS_BOX && session.role !== "judge" && html`<a class="short" href=${address("/box", {zone: name})}>${texts.whole_box}</a>`}
      <a class="short" href=${address("/pair")}>${session.person} · ${roleText(session, texts)}</a>
    </header>`;
}

// Which other zones need their referee. It stays in sight while a zone is scored. From old data nobody knows that none does.
function Others({zones, zone, texts}) {
  const quiet = state.live.silentSince === null ? texts.others_quiet : texts.all_zones;
  const urgent = zones.filter((one) => one.is_urgent && !(zone && one.zone === zone.zone));
  return html`
    <button type="button" class="others ${urgent.length > 0 ? "urgent" : ""}" data-meaning="zones" onClick=${() => choose(true)}>
      <span>${urgent.length > 0 ? urgent.map((one) => `⚠ ${one.zone}: ${one.todo}`).join(" · ") : quiet}</span>
    </button>`;
}

// All zones, beside STOP: a list of the browser would cover it.
function Zones({zones, texts}) {
  return html`
    <section class="choice" role="dialog" aria-label=${texts.zone}>
      ${zones.map((one) => html`
        <button type="button" key=${one.zone} data-zone=${one.zone} data-meaning=${one.zone} onClick=${() => openZone(one.zone)}>
          <strong>${one.zone}</strong> · ${one.team} · ${one.phase}<br />${one.is_urgent && "⚠ "}${one.todo}</button>`)}
      <button type="button" onClick=${() => choose(false)}>${texts.close}</button>
    </section>`;
}

const isRunning = () => Boolean(state.known && state.known.phase === "running");

// Signals for the ear and the hand: the start, 30 s and 10 s before the end, and the end.
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
      strip.signal(440, [600, 150, 600]);
    } else if (was.phase !== "running" && now.phase === "running") {
      strip.signal(660, [300]);
    } else if (now.phase === "running" && now.hurry >= SOON && was.hurry < now.hurry) {
      strip.signal(550, [200]);
    }
  });
}

// A button that is new, or that means something else now, does nothing for a moment, and shows it.
const meanings = new WeakMap();
function holdChanged() {
  for (const button of place.querySelectorAll("button")) {
    const meaning = button.dataset.meaning || button.textContent, before = meanings.get(button);
    if (!before || before.meaning !== meaning) {
      clearTimeout(before && before.timer);
      button.dataset.changed = "changed";
      meanings.set(button, {meaning, timer: setTimeout(() => delete button.dataset.changed, CHANGED_MS)});
    }
  }
}
// Whatever drew it: a part of the page may draw itself, such as a sheet that was asked for.
new MutationObserver(holdChanged).observe(place, {subtree: true, childList: true, characterData: true});
place.addEventListener("click", (event) => {
  if (event.target.closest("[data-changed]")) {
    event.preventDefault();
    event.stopPropagation();
  } else if (state.gone) {
    state.gone = "";
    draw();
  }
}, true);

// What a locked page must not hide: what needs its referee.
function Urgent({zone, zones}) {
  const others = (zones || []).filter((one) => one.is_urgent && one.zone !== state.shown);
  setOnLock([...(zone && zone.is_urgent ? [zone.todo] : []), ...others.map((one) => `${one.zone}: ${one.todo}`)]
    .map((line) => `⚠ ${line}`).join("\n"));
  return null;
}

function Page() {
  const {live, session, marks} = state;
  const data = live ? live.data : {};
  const words = data["page.words"], texts = data["page.device_words"];
  const zone = live && zoneNow();
  if (session === undefined || !("page.device_words" in data)) {
    return null;
  }
  if (!words || !texts) {
    strip.failed("texts", "the web gateway cannot make them: see its log");
    return null;
  }
  strip.works("texts");
  document.documentElement.lang = words.language;
  document.title = zone ? `${zone.zone} – ${texts.referee_page}` : texts.referee_page;
  if (session === null) {
    return html`
      <h1 class="title">${texts.not_paired}</h1>
      <p class="nothing">${texts.pair_how}</p>
      <p><a class="button main" href=${address("/pair")}>${texts.pair_title}</a></p>`;
  }
  if (state.isEnded) {
    return html`<h1 class="title" role="status">${texts.box_ended}</h1><p class="nothing">${texts.box_ended_how}</p>`;
  }
  const isOld = live.silentSince !== null || !zone;
  document.body.classList.toggle("old", isOld);
  const judge = session.role === "judge" ? session.person : "";
  const zones = session.zone ? null : data["page.zones"];
  const isJudged = Boolean(zone) && zone.judging.some((run) => run.identity === zone.identity && run.count > 0);
  const late = waitingText(marks, texts);
  const trouble = marks.refused.length > 0 ? refusedText(marks.refused[0], texts) : late ? late
    : !zone && live.silentSince === null ? noZone(texts) : "";
  strip.note(trouble || (live.silentSince === null ? state.gone || state.said : texts.not_current),
    Boolean(trouble || state.gone) || isOld);
  const part = (name, made) => html`<${Guard} key=${name} name=${name}>${made}<//>`;
  return html`
    ${part(texts.zone, html`<${Header} zone=${zone} zones=${zones} session=${session} texts=${texts} />`)}
    ${zones && zones.length > 1 && part(texts.all_zones, html`<${Others} zones=${zones} zone=${zone} texts=${texts} />`)}
    ${part("⚠", html`<${Urgent} zone=${zone} zones=${zones} />`)}
    ${zones && state.isChoosing && part("…", html`<${Zones} zones=${zones} texts=${texts} />`)}
    ${IS_BOX && part("nav", html`<${Nav} session=${session} part=${state.part} open=${openPart} texts=${texts} zones=${zones} />`)}
    ${zone && state.part !== OWN ? html`
      <fieldset disabled=${isOld} class="all whole">${part(texts[`part_${state.part}`], html`
        <${Part} key=${state.part} part=${state.part} data=${data[`part.${state.part}`]} zone=${zone} zones=${data["page.zones"]}
          session=${session} texts=${texts} marks=${marks} give=${give} undo=${(last) => undo(last, texts)}
          openZone=${openInZone} ended=${ended} />`)}</fieldset>` : zone ? html`
      <div class="all">
        <fieldset disabled=${isOld}>
          ${part(texts.time, html`<${Run} zone=${zone} texts=${texts} />`)}
          ${part(texts.state, html`<${Now} zone=${zone} texts=${texts} judge=${judge} />`)}
        </fieldset>
        <div>
          ${!judge && html`<fieldset disabled=${isOld}>
            ${part(texts.commands, html`<${Commands} zone=${zone} texts=${texts} />`)}
            ${part(texts.unsigned, html`<${Over} zone=${zone} texts=${texts} />`)}</fieldset>`}
          ${judge && part(texts.judges, zone.judging.filter((run) => run.count > 0).map((run) => html`
            <${JudgeRun} key=${run.identity} zone=${zone.zone} run=${run} marks=${marks} texts=${texts} person=${judge}
              give=${give} />`))}
          ${isJudged && !judge && html`<p class="nothing">${texts.judges_score}</p>`}
          ${zone.items.length > 0 && !isJudged && part(texts.sheet, html`
            <${Sheet} key=${zone.identity} zone=${zone} marks=${marks} texts=${texts} judge=${judge}
              undo=${judge ? null : (last) => undo(last, texts)} give=${give} />`)}
          ${!judge && zone.switches && part(texts.switches, html`<fieldset disabled=${isOld}><${Switches} zone=${zone} texts=${texts} /></fieldset>`)}
        </div>
      </div>` : html`<p class="nothing">${live.silentSince === null ? noZone(texts) : words.waiting}</p>`}`;
}

// Why no zone is shown.
function noZone(texts) {
  return isGone(state.live.data["page.zones"]) ? texts.own_zone_gone.replace("{zone}", () => state.shown) : texts.no_data;
}

state.marks = new Marks(draw);
window.marks = state.marks;
listen(place, (key) => {
  const texts = state.live && state.live.data["page.device_words"];
  state.said = texts && key ? texts.really.replace("{command}", () => key) : "";
  draw();
});
const setOnLock = lockWhenIdle(place, () => state.live && state.live.data["page.device_words"], isRunning);
begin();
