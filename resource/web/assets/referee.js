// The page of a referee, judge or organiser on a phone, tablet or laptop (docs/web.md, "Referees").

import {Component, Icon, TeamMark, address, countdown, html, parameters, useEffect, useLayoutEffect, useRef, useState} from "/assets/parts.js";
import {render} from "/assets/vendor/preact-htm.js";
import {Live} from "/assets/live.js";
import {ask, reasonsText, roleText} from "/assets/device.js";
import {Marks, nameOf, send} from "/assets/commands.js";
import {Command, CommandRow, Twice} from "/assets/buttons.js";
import {Keys, listen} from "/assets/keys.js";
import {drop, keep, kept} from "/assets/kept.js";
import {lockWhenIdle} from "/assets/lock.js";
import {Missing, stayAwake} from "/assets/phone.js";
import {Nav, Part, isSent, partsOf} from "/assets/box.js";
import {HeadReferee, JudgeRun} from "/assets/judging.js";
import {FinishedRun, Proposals} from "/assets/runs.js";
import {RefusedMark, Sheet, counted} from "/assets/sheet.js";

const SILENT_S = 2.2;
const ASK_AGAIN_MS = 1500;
const SOON = 1;
const SWITCHES = 10;
const CHANGED_MS = 600, NEXT_MS = 1500;
const STILL_MS = 3000;
const SHOWN = "shown", KEPT_MS = 2000;
const SMALL = 608;  // pixels: of a lower screen, the sheet begins under the strip

const language = parameters.get("language") || "";
const place = document.getElementById("page");
const {strip} = window;  // STOP: see stop.js
const IS_BOX = location.pathname === "/box";  // the page of the whole box: with parts, of which one is open
const OWN = "zone";  // the part that the referee's page consists of
const state = {session: undefined, live: null, known: null, said: "", place: "", marks: null, ticks: new Set(), isChoosing: false, drawer: "", touchedAt: -Infinity,
  part: IS_BOX ? parameters.get("part") || "overview" : OWN,
  shown: "",  // the zone that was shown last
  gone: "",  // that a zone is gone, until the reader touches the page
  isEnded: false};  // the box was ended here, and is not heard again yet

// What a screen holds is counted in letters: phones of 2021 cannot ask for that in a style sheet.
const NARROW_REM = 17;
const fit = () => document.body.classList.toggle("narrow",
  innerWidth < NARROW_REM * parseFloat(getComputedStyle(document.documentElement).fontSize));
window.addEventListener("resize", fit);

function draw() {
  fit();
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
  if (names.length === 1 && names[0] === "page.clock" && state.ticks.size > 0) {
    state.ticks.forEach((tick) => tick());  // comes each second, and drawing the whole page takes long on a slow phone
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

// A phase without its capitals, which are for texts that have no colours.
const quietly = (text) => text.replace(/^[\p{Lu} ]+(?!\p{Ll})/u, (loud) => loud[0] + loud.slice(1).toLowerCase());

function useTicks() {
  const [, redraw] = useState(0);
  useEffect(() => {
    const tick = () => redraw((before) => before + 1);
    state.ticks.add(tick);
    return () => state.ticks.delete(tick);
  }, []);
  return state.live.data["page.clock"] || {main: {text: "", label: ""}};
}

// Who, what and how long, on the colour of the state. It stays in sight.
function Run({zone, zones, texts}) {
  const clock = useTicks(), {look} = zone;
  useSignals(zone, state.live.data["page.clock"]);
  const who = html`
    <${TeamMark} key=${zone.team} team=${zone.team} live=${state.live} />
    <span class="names"><span class="team short" role="heading" aria-level="1">${zone.team}</span>
      <span class="short"><${Icon} name=${look} solid=${["executing", "stopped"].includes(look)} /><span class="unseen">${texts.state}: </span>
        ${zone.zone}${zones && zones.length > 1 && " ▾"} · <span class="phase">${quietly(zone.phase_text)}</span></span></span>`;
  return html`
    <section class="strip band run ${zone.phase} ${look} ${clock.pause ? "paused" : ""}" aria-label=${texts.time}>
      ${zones ? html`<button type="button" class="who zones" data-meaning="zones" aria-expanded=${state.isChoosing} onClick=${() => choose(!state.isChoosing)}>${who}</button>`
        : html`<div class="who">${who}</div>`}
      <div class="strip-clock" key=${zone.phase}><span class="unseen">${clock.main.label}</span>
        <b class="clock ${clock.main.hurry ? "hurry" : ""}">${clock.main.text}</b><small>${clock.below}</small></div>
      <span class="progress" style="--part: ${clock.part || 0}"></span>
    </section>`;
}

// The clock of a phase or a goal, and why the run's clock does not count.
function SecondClock() {
  const {goal, pause} = useTicks();
  return html`<p class="second-clock short">${pause || goal && html`${goal.label} <b class=${goal.hurry ? "hurry" : ""}>${goal.text}</b>`}</p>`;
}

// The last mark of this device, and Undo. What is wrong in the run is said in the same place.
function Last({zone, texts, session}) {
  const {marks} = state, ofRun = ({identity}) => identity === zone.identity, last = marks.last(zone.identity);
  const waiting = marks.waiting.filter(ofRun), count = marks.done.filter(ofRun).length + waiting.length;
  const shown = waiting.length > 0 ? waiting[waiting.length - 1] : last;
  const isTodo = zone.is_urgent || !shown || zone.phase === "idle";
  return html`
    <section class="last">
      <button type="button" class="to-more" data-meaning="more" onClick=${() => openDrawer(isTodo ? "more" : "timeline")}>
        <${Icon} name=${zone.is_urgent ? "warning" : isTodo ? "now" : "timeline"} />
        <span key=${`${isTodo && zone.todo} ${waiting.some(({isLate}) => isLate)}`}>${isTodo ? html`<span class="todo ${zone.is_urgent ? "urgent" : ""}" role="status">${zone.todo}</span>`
          : html`<span class="lines-1 said">${waiting.length > 0 ? nameOf(shown) : shown.shown}</span>`}
          <span class="unseen"><${Icon} name="pending" /></span>${waiting.some(({isLate}) => isLate) ? html`<span class="chip pending small"><${Icon} name="pending" />${texts.marks_waiting
            .replace("{number}", () => count).replace("{waiting}", () => waiting.length)}</span>`
            : !isTodo && html`<small class="lines-1">${texts.marks_sent.replace("{number}", () => count)}</small>`}</span>
      </button>
      ${session.role !== "judge" && may(texts, "take_back") && zone.items.length > 0 && html`
        <button type="button" class="button second" data-command="undo" data-meaning="undo" disabled=${!last} onClick=${() => undo(last, texts)}
            aria-label=${last ? texts.undo.replace("{mark}", () => last.shown) : texts.nothing_to_undo}>
          <span class="stack"><${Icon} name="undo" /><span>${texts.nothing_to_undo}</span></span></button>`}
    </section>`;
}

// Incidents of the rules that have a place of their own, by their names there.
const INCIDENTS = {inactive: "waiting", restart: "restart", removed: "removed"};

const find = (zone, field, name) => zone.items.find((item) => item.is_incident && item[field] === name);
const times = (zone, item) => item ? counted(item, state.marks.waiting.filter((one) => one.identity === zone.identity
  && one.group === item.group && one.desc === item.desc)) : 0;
const sum = (zone, names) => names.reduce((all, name) => all + times(zone, find(zone, "desc", name)), 0);
// Whether an incident that others end has not ended.
const isGoing = (zone, item) => item.until.length > 0 && times(zone, item) > sum(zone, item.until);
const happen = (zone, item) => state.marks.add({zone: zone.zone, identity: zone.identity, group: item.group, desc: item.desc, added: "1", shown: "+1"});

// What a robot does again is not inactive any more.
function endInactivity(zone, marked) {
  if (!marked.is_incident && !marked.is_penalty) {
    zone.items.filter((item) => item.is_incident && item.after && isGoing(zone, item))
      .forEach((item) => happen(zone, find(zone, "desc", item.until[0])));
  }
}

function Incident({zone, item, texts}) {
  useTicks();
  const begun = useRef(null);
  const isOn = Boolean(item.after) && isGoing(zone, item), now = state.live.now() || Date.now() / 1000;
  const number = times(zone, item);
  if (isOn && (!begun.current || begun.current.number !== number)) {
    begun.current = {number, at: times(zone, item) === item.value && begunAt(zone, item) || now};
  }
  begun.current = isOn ? begun.current : null;
  const left = isOn ? Math.max(0, Number(item.after) - (now - begun.current.at)) : 0;
  const act = () => !item.after || !may(texts, "mark") ? openDrawer("happened") : happen(zone, isOn ? find(zone, "desc", item.until[0]) : item);
  return html`
    <button type="button" class=${isOn ? "active" : ""} data-incident=${item.incident} data-meaning=${`${item.desc} ${isOn}`} onClick=${act}>
      ${isOn ? html`<b>${countdown(left)}</b>` : html`<${Icon} name=${INCIDENTS[item.incident]} />`}
      <span>${item.name}${item.after ? "" : ` ${number}${item.max ? `/${item.max}` : ""}`}</span>
      ${isOn && html`<span class="progress" style="--part: ${1 - left / Number(item.after)}"></span>`}
    </button>`;
}

const happenings = () => (state.live.data["page.timeline"] || {items: []}).items;

// When an incident began, wherever it was entered, as far as the box knows.
const begunAt = (zone, item) => (happenings().find(({group, desc, state}) => group === item.group && desc === item.desc && state !== "withdrawn") || {}).utc_s;

const SIGNS = {note: "note", start: "executing", restart: "executing", continue: "executing", resume: "executing", phase: "executing", goal: "now",
  pause: "pause", stop: "stopped", end: "completed", connect: "robot", disconnect: "robot", sign_off: "sign", outage: "offline"};
const SOLID = ["executing", "stopped"];

// What happened in the run, the latest first.
function Timeline({zone, texts}) {
  const {items, hidden = 0} = state.live.data["page.timeline"] || {items: []};
  return html`
    ${items.length === 0 && html`<p class="nothing">${texts.no_timeline}</p>`}
    <ol class="timeline">${items.map((one) => html`<${Happening} key=${one.id} one=${one} zone=${zone} texts=${texts} />`)}</ol>
    ${hidden > 0 && html`<p class="nothing">${texts.older.replace("{number}", () => hidden)}</p>`}`;
}

function Happening({one, zone, texts}) {
  const [typed, setTyped] = useState(null);
  const {kind, state: how, points = ""} = one, isLoss = points.startsWith("−");
  const sign = SIGNS[kind] || (isLoss ? "flag" : "check"), look = kind !== "mark" ? "" : isLoss ? "penalty" : points && "achievement";
  const save = (event) => {
    event.preventDefault();
    setTyped(null);
    state.marks.add({zone: zone.zone, identity: zone.identity, command: "note", number: one.number, text: typed.trim(), shown: typed.trim()});
  };
  return html`
    <li class=${how || ""}><time>${one.clock || one.time.split(":").slice(0, 2).join(":")}</time><span class="chip ${look}"><${Icon} name=${sign} solid=${SOLID.includes(sign)} /></span>
      <span><span class=${["mark", "note"].includes(kind) ? "" : "phase"}>${one.text}${one.note && `: ${one.note}`}</span>
        <small>${[one.who && [one.who, one.role].filter(Boolean).join(", "), one.said].filter(Boolean).join(" · ")}</small></span>
      ${kind === "note" ? html`<button type="button" class="button quiet" data-meaning=${one.id} onClick=${() => setTyped(typed === null ? "" : null)}>${texts.add_text}</button>`
        : html`<span class="number ${look}">${points || one.change}</span>`}
      ${typed !== null && html`<form class="entry" onSubmit=${save}><label><span class="unseen">${texts.shown_text}</span>
        <input maxlength="200" value=${typed} onInput=${(event) => setTyped(event.target.value)} /></label><button class="button">${texts.save}</button></form>`}
    </li>`;
}

function Tools({zone, texts}) {
  const shown = Object.keys(INCIDENTS).map((name) => find(zone, "incident", name)).filter(Boolean);
  const others = zone.items.filter((item) => item.is_incident && !shown.includes(item));
  return html`
    <section class="incidents" aria-label=${zone.incidents || texts.more}>
      ${shown.map((item) => html`<${Incident} key=${item.desc} zone=${zone} item=${item} texts=${texts} />`)}
      ${shown.length === 0 && others.length > 0 && html`<button type="button" data-meaning="incidents" onClick=${() => openDrawer("happened")}><${Icon} name="flag" /><span>${zone.incidents}</span></button>`}
      <button type="button" class="to-more" data-meaning="more" onClick=${() => openDrawer("more")}><${Icon} name="more" /><span>${texts.more}</span></button>
    </section>`;
}

// Before the run: what to know and to choose.
function Checks({zone, texts}) {
  return html`
    <section class="checks" aria-label=${texts.state}>
      <div class="sheet-head"><h2>${zone.title}</h2><p class="quiet small">${zone.facts}</p></div>
      <${State} zone=${zone} />
      <${Earlier} zone=${zone} texts=${texts} />
      ${zone.robots.length > 0 && html`<div class="controls block">${zone.robots.map((robot) => html`
        <${zone.questions.connect ? Twice : Command} key=${robot} label=${texts.connect_robot.replace("{robot}", () => robot)}
          question=${texts.really} act=${() => give("connect", texts, robot, shownOf(zone, "connect", texts.actions.connect, {robot}))} />`)}</div>`}
    </section>`;
}

const State = ({zone}) => html`
  <ul class="rows">
    ${zone.warnings.map((text) => html`<li key=${text}><span class="chip warning"><${Icon} name="warning" /></span><span>${text}</span></li>`)}
    ${zone.state.map((line) => html`<li key=${line}><span class="chip"><${Icon} name="check" /></span><span>${line}</span></li>`)}
  </ul>`;

// Incidents of earlier runs of the team: a warning may be the second one.
const Earlier = ({zone, texts}) => zone.earlier.length > 0 && html`
  <ul class="rows" aria-label=${texts.earlier}>${zone.earlier.map(({run, text}) => html`
    <li key=${run}><span class="chip penalty"><${Icon} name="flag" /></span><span>${texts.earlier}: ${text} <small>${run}</small></span></li>`)}</ul>`;

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
  const {on, damaged} = zone.switches;
  const numbers = Array.from({length: SWITCHES}, (_, i) => i + 1);
  return html`
    <section class="switches">
      <div class="sheet-head"><h2>${texts.switches}</h2></div>
      <div class="controls block">
        ${numbers.map((number) => html`
          <button type="button" class="button" data-meaning=${number} aria-pressed=${on.includes(number)} onClick=${() => give("switch", texts, String(number), {number})}>
            ${number}: ${on.includes(number) ? texts.is_on : texts.is_off}
          </button>`)}
      </div>
      <ul><li class="item penalty"><span class="item-name">${texts.damaged}</span>
        ${[["take-back", "undo", damaged - 1], ["mark", "flag", damaged + 1]].map(([look, icon, number], i) => html`${i > 0 && html`<span class="value has">${damaged}</span>`}
          <button type="button" class="${look} ${number < 0 ? "none" : ""}" disabled=${number < 0} data-meaning=${look} onClick=${() => give("damaged", texts, texts.damaged, {number})}>
            <${Icon} name=${icon} />${i > 0 && "+1"}<span class="unseen"> ${i > 0 ? texts.damaged : texts.subtract.replace("{item}", () => texts.damaged)}</span></button>`)}</li></ul>
    </section>`;
}

// Commands that this page lays out itself, beside those that most runs do not need. All others are in the drawer, with a
// form if somebody must enter something.
const PLACED = ["connect", "start", "disconnect", "stop", "switch", "damaged", "confirm_switches"];
const ENTERED = ["name", "text", "number", "decimal", "pose", "choice", "toggle"];
const FILLED = ["team", "fixed", "confirmed"];
// How what is measured is typed.
const HINTS = {pose: "x y ° (1.25 0.40 90)", decimal: "0.5"};

const isForm = ([, {fields}]) => fields.some(({kind}) => ENTERED.includes(kind));

// The actions without a place of their own, with their fields as they are now.
const may = (texts, name) => texts.may[state.session.role].includes(name);

function offered(zone, texts) {
  return Object.entries(texts.actions).map(([name, action]) => [name, {...action, fields: zone.fields[name] || action.fields}])
    .filter(([name, {fields}]) => may(texts, name) && !PLACED.includes(name) && name in zone.off && zone.shown[name]
      && fields.every(({kind}) => [...ENTERED, ...FILLED].includes(kind)));
}

function oneOf(zone, texts, name, more = {}) {
  const action = texts.actions[name];
  return {
    name, label: action.label, question: texts.really, reasons: zone.off[name] || [], explanation: action.explanation,
    isTwice: action.careful || Boolean(zone.questions[name]), key: `${name} ${zone.event} ${zone.identity}`,
    warning: action.leaves && isMoving(zone) ? zone.leaving : "",
    act: () => give(name, texts, action.label, shownOf(zone, name, action)), ...more,
  };
}

// The next action, and one beside it, as far as the role may do them.
const actionsOf = (zone, texts) => placedOf(zone, texts).map((one) => one && may(texts, one.name) ? one : null);

function placedOf(zone, texts) {
  const one = (name, more = {}) => oneOf(zone, texts, name, more);
  const isOn = (name) => name in zone.off && zone.shown[name] && zone.off[name].length === 0;
  const run = toSign(zone), again = one("start", {label: texts.continue, isTwice: true});
  if (zone.switches && zone.switches.to_confirm) {
    return [{name: "confirm_switches", label: texts.confirm, small: texts.switches, act: () => give("confirm_switches", texts, texts.confirm)}];
  }
  const pressing = ["continue", "resume", "next_phase"].find(isOn);
  if (zone.phase === "running" || pressing) {
    return [pressing && one(pressing), !pressing && isOn("pause") && one("pause")];
  }
  if (zone.phase === "connected") {
    return [one("start"), one("disconnect")];
  }
  if (zone.phase === "ended") {
    return [one("disconnect"), again];
  }
  if (run) {
    const isWaiting = state.marks.waiting.some(({identity}) => identity === run.identity);
    return [{name: "sign_off", key: `${run.identity} ${run.revision}`, label: texts.sign_off, small: unheardText(run, texts) || run.score, isTwice: true, question: texts.really, icon: "sign",
      reasons: isWaiting ? [texts.marks_wait] : [], act: () => give("sign_off", texts, texts.sign_off, {identity: run.identity})}, one("connect")];
  }
  return zone.questions.connect ? [one("next"), one("connect")] : zone.robots.length > 0 ? [] : [one("connect")];
}

// The run of the present event that waits for its sign-off. Where judges score, the head referee settles first.
function toSign(zone) {
  const run = zone.unsigned.find(({is_here}) => is_here);
  return run && zone.judging.every(({identity, count}) => identity !== run.identity || count === 0) ? run : undefined;
}

// Whose devices may have marks that did not arrive.
const unheardText = ({unheard}, texts) => unheard.length > 0 ? `⚠ ${texts.unheard.replace("{names}", () => unheard.join(", "))}` : "";

const isNext = ({leaving, phase}) => !(leaving && phase === "ended");

function Act({isTwice, warning, icon, explanation, ...command}) {
  return html`<${isTwice ? Twice : Command} ...${command}>${icon && html`<${Icon} name=${icon} />`}<//>`;
}

// The next action is always in the same place, above STOP.
function Dock({zone, texts, isOld}) {
  const [next, second] = actionsOf(zone, texts);
  const why = [next, second].find((one) => one && one.warning);
  const note = () => state.marks.add({zone: zone.zone, identity: zone.identity, command: "note", shown: texts.note_moment});
  return html`
    <section class="dock" aria-label=${texts.commands}>
      ${why && html`<p class="dock-why alarm">⚠ ${why.label}: ${why.warning}</p>`}
      <fieldset disabled=${isOld}>${next && html`<${Act} ...${next} isMain=${isNext(zone)} />`}
      ${second && html`<div class=${next ? "second" : "command"}><${Act} ...${second} isBare /></div>`}</fieldset>
      ${zone.phase === "running" && may(texts, "note") && html`<div class="second"><${Command} name="note" label=${texts.note_moment} act=${note} isStacked><${Icon} name="moment" /><//></div>`}
    </section>`;
}

// What is not needed now.
function More({zone, zones, texts, session}) {
  const placed = actionsOf(zone, texts).filter(Boolean).map(({name}) => name);
  const others = offered(zone, texts).filter(([name, {row}]) => row !== "module" && !placed.includes(name));
  const rows = others.filter((other) => !isForm(other)).map(([name]) => oneOf(zone, texts, name));
  return html`
    ${zone.phase !== "idle" && html`<${State} zone=${zone} />`}
    <ul class="rows commands">
      ${[...(zone.phase === "running" && may(texts, "disconnect") ? [oneOf(zone, texts, "disconnect")] : []), ...rows]
        .sort((a, b) => a.reasons.length - b.reasons.length).map((command) => html`<${CommandRow} ...${command} />`)}
    </ul>
    ${others.filter(isForm).map(([name, action]) => html`
      <details key=${name} class="block">
        <summary>${action.label}</summary>
        <${Form} key="${zone.event} ${zone.identity}" command=${oneOf(zone, texts, name)} action=${action} zone=${zone} texts=${texts} />
      </details>`)}
    ${zone.phase === "ended" && zone.end === "stopped" && may(texts, "stop_reason") && html`
      <details class="block">
        <summary>${texts.stop_reason}</summary>
        <${Reason} key=${zone.identity} zone=${zone} texts=${texts} />
      </details>`}
    <${Keys} texts=${texts} />
    <${Missing} texts=${texts} />
    <p class="links block">
      ${!IS_BOX && html`<a class="button" href=${address("/box", {zone: zone.zone})}>${texts.whole_box}</a>`}
      <a class="button" href=${address("/pair")}>${session.person} · ${roleText(session, texts)}</a></p>`;
}

// One open drawer. It ends above the next action. On a wide screen, what it has is beside the sheet.
function Drawer({name, title, texts, children}) {
  const isOpen = state.drawer === name;
  return html`
    <section class="drawer ${name} ${isOpen ? "" : "closed"}" aria-label=${title}>
      <header><h2>${title}</h2><button type="button" class="button quiet" data-meaning="close" onClick=${() => openDrawer("")}><${Icon} name="close" /> ${texts.close}</button></header>
      <div class="body" tabindex="0">${children}</div>
    </section>`;
}

function openDrawer(name) {
  state.drawer = state.drawer === name ? "" : name;
  draw();
}

// What was typed into the fields of an action.
function useForm(name, action, zone, texts) {
  const [given, setGiven] = useState({});
  const fields = action.fields.filter(({kind}) => ENTERED.includes(kind));
  const isMissing = fields.some(({name, required, kind}) => required && kind !== "toggle" && !String(given[name] === undefined ? "" : given[name]).trim());
  const toggles = fields.filter(({kind}) => kind === "toggle").map(({name}) => [name, false]);
  const act = async (more) => {
    if (await give(name, texts, action.label, shownOf(zone, name, action, {...Object.fromEntries(toggles), ...given, ...more}))) {
      setGiven({});
    }
  };
  const [only] = fields, choices = fields.length === 1 && only.kind === "choice" ? only.choices : null;
  const inputs = choices ? [] : fields.map((field) => html`
    <label key=${field.name}>${field.label}${field.unit ? ` (${field.unit})` : ""}
      <${Input} field=${field} value=${given[field.name]} set=${(value) => setGiven((before) => ({...before, [field.name]: value}))} /></label>`);
  const reasons = zone.off[name].length > 0 || !isMissing ? zone.off[name] : [texts.fill_in];
  const buttons = (isMain) => choices ? choices.map((choice) => html`
    <${Command} key=${choice} label=${choice} isMain=${isMain && choices.length < 4} reasons=${zone.off[name]} act=${() => act({[only.name]: choice})} />`)
    : html`<${Command} name=${name} label=${action.label} isMain=${isMain} reasons=${reasons} act=${() => act()} />`;
  return {inputs, buttons};
}

function Form({command, action, zone, texts}) {
  const {inputs, buttons} = useForm(command.name, action, zone, texts);
  return html`<div class="form"><p class="facts">${action.explanation}</p>${inputs}<div class="controls">${buttons(false)}</div></div>`;
}

// What a module asks the referee to do, at full height. Its button comes when the end of the text was seen.
function Instruction({zone, texts, name, action}) {
  const {inputs, buttons} = useForm(name, action, zone, texts);
  const [isRead, setRead] = useState(false);
  const end = useRef(null), dock = useRef(null);
  useEffect(() => {
    const look = () => end.current.getBoundingClientRect().bottom <= dock.current.getBoundingClientRect().top && setRead(true);
    look();
    ["scroll", "resize"].forEach((kind) => window.addEventListener(kind, look));
    return () => ["scroll", "resize"].forEach((kind) => window.removeEventListener(kind, look));
  });
  const readOn = () => scrollBy(0, (dock.current.getBoundingClientRect().top - end.current.parentNode.parentNode.parentNode.firstElementChild.getBoundingClientRect().bottom) * 0.6 || innerHeight / 3);
  return html`
    <section class="now operation" aria-label=${action.label}>
      <div class="asks">
        <p class="quiet small">${action.label}</p>
        <p class="asked" role="alert">${zone.texts[name] || zone.todo}</p>
        <p class="quiet">${action.explanation}</p>
        ${inputs}
        <span class="end" ref=${end}></span>
      </div>
      <div class="dock controls" ref=${dock}>${isRead ? buttons(true)
        : html`<${Command} label=${texts.read_on} isMain act=${readOn}><${Icon} name="down" /><//>`}</div>
    </section>`;
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
      <button class="button">${texts.save}</button>
      ${saved && html`<p role="status">${texts.saved}: ${saved}</p>`}
    </form>`;
}

// The runs that are over: their sheets, their judges, their results.
function Over({zone, texts}) {
  const judged = zone.judging.filter((run) => run.count > 0);
  const identities = new Set([...judged, ...zone.unsigned].map((run) => run.identity));
  const differences = judged.reduce((all, run) => all + run.differences, 0);
  return html`
    <details class="over block" open=${zone.phase === "idle" && zone.unsigned.some(({is_here}) => is_here)}>
      <summary>${texts.unsigned}: ${identities.size + zone.unlisted}${differences > 0
        && ` · ⚠ ${texts.differences.replace("{number}", () => differences)}`}</summary>
      ${judged.map((run) => html`
        <${HeadReferee} key=${run.identity} zone=${zone.zone} run=${run} texts=${texts} give=${give} />`)}
      <ul class="unsigned">${zone.unsigned.map((run) => html`
        ${run.unheard.length > 0 && html`<li class="banner warning">${unheardText(run, texts)}</li>`}
        <${FinishedRun} key=${run.identity} zone=${zone} run=${run} marks=${state.marks} texts=${texts} give=${give}
          undo=${(last) => undo(last, texts)} isInDock=${zone.phase === "idle" && run === toSign(zone)} />`)}</ul>
      ${zone.unlisted > 0 && html`<p class="facts">${texts.hidden.replace("{number}", () => zone.unlisted)}</p>`}
    </details>`;
}

// Whether what a module asks for is open. It opens when nobody has touched the page for a moment, because it takes the place
// of the sheet: else the next action leads to it.
function useInstruction(asked, before) {
  const [opened, setOpened] = useState("");
  const open = () => {
    before.current = scrollY;  // where the sheet is, to which the reader comes back
    setOpened(asked);
  };
  useEffect(() => {
    const timer = asked && opened !== asked && setInterval(() => performance.now() - state.touchedAt > STILL_MS && open(), 200);
    return () => clearInterval(timer);
  }, [asked, opened]);
  return [opened === asked, open];
}

// The zone: during a run, its sheet is the page.
function ZonePage({zone, zones, session, texts, isOld}) {
  const judge = session.role === "judge" ? session.person : "", {marks} = state;
  const part = (name, made) => html`<${Guard} key=${name} name=${name}>${made}<//>`;
  const [ask] = judge ? [] : offered(zone, texts).filter(([, {row}]) => row === "module");
  const asked = ask ? `${zone.identity} ${JSON.stringify(ask.map((one) => one.fields || one))} ${zone.texts[ask[0]]}` : "";
  const before = useRef(0);
  const [isOpen, open] = useInstruction(asked, before);
  const isInstruction = Boolean(asked) && isOpen;
  useLayoutEffect(() => {
    scrollTo(0, isInstruction ? 0 : before.current);
  }, [isInstruction]);
  useEffect(() => {
    zone.phase === "running" && innerHeight < SMALL && document.querySelector(".sheets").scrollIntoView();
  }, [zone.phase]);
  const isJudged = zone.judging.some((run) => run.identity === zone.identity && run.count > 0);
  const isBefore = ["idle", "connected"].includes(zone.phase);
  return html`
    <header class="head">
      ${part(texts.time, html`<${Run} zone=${zone} zones=${zones} texts=${texts} />`)}
      ${zones && zones.length > 1 && part(texts.all_zones, html`<${Others} zones=${zones} zone=${zone} texts=${texts} />`)}
      ${!judge && zone.has_second_clock && html`<${SecondClock} />`}
      ${part(texts.state, html`<${Last} zone=${zone} texts=${texts} session=${session} />`)}
      ${!judge && part(texts.more, html`<${Tools} key=${zone.items.length > 0} zone=${zone} texts=${texts} />`)}
    </header>
    <div class="all">
      <div class="sheets ${isInstruction ? "covered" : ""}">
        ${zone.switches && may(texts, "switch") && part(texts.switches, html`<${Switches} zone=${zone} texts=${texts} />`)}
        ${isBefore && part("✓", html`<fieldset disabled=${isOld}><${Checks} key=${zone.phase} zone=${zone} texts=${texts} /></fieldset>`)}
        ${judge && part(texts.judges, zone.judging.filter((run) => run.count > 0).map((run) => html`
          <${JudgeRun} key=${run.identity} zone=${zone.zone} run=${run} marks=${marks} texts=${texts} person=${judge} give=${give} isOld=${isOld} />`))}
        ${isJudged && !judge && html`<p class="nothing">${texts.judges_score}</p>`}
        ${zone.items.length > 0 && !isJudged && part(texts.sheet, html`
          <${Sheet} key="${zone.identity} ${isBefore}" zone=${zone} happenings=${happenings()} marks=${marks} texts=${texts} judge=${judge} give=${may(texts, "in_time") ? give : null} isFixed=${!may(texts, "mark")} only="items"
            onMark=${(item) => endInactivity(zone, item)} />`)}
        ${may(texts, "decide") && zone.phase !== "running" && part(texts.proposals, html`<fieldset disabled=${isOld}>${zone.proposed.map((run) => html`
          <${Proposals} key=${run.identity} zone=${zone} run=${run} texts=${texts} give=${give} />`)}</fieldset>`)}
        ${may(texts, "sign_off") && ["idle", "ended"].includes(zone.phase) && part(texts.unsigned, html`<fieldset disabled=${isOld}><${Over} zone=${zone} texts=${texts} /></fieldset>`)}
      </div>
      ${!judge && html`<div class="aside">
        ${isInstruction && part(ask[0], html`<fieldset disabled=${isOld}><${Instruction} key=${asked} zone=${zone} texts=${texts} name=${ask[0]} action=${ask[1]} /></fieldset>`)}
        <${Drawer} name="happened" title=${zone.incidents} texts=${texts}>${part(zone.incidents, html`<${Sheet} zone=${zone} marks=${marks} texts=${texts} give=${give} isFixed=${!may(texts, "mark")} only="incidents" />
          <${Earlier} zone=${zone} texts=${texts} />`)}<//>
        <${Drawer} name="timeline" title=${texts.timeline} texts=${texts}>${part(texts.timeline, html`<${Timeline} zone=${zone} texts=${texts} />`)}<//>
        <${Drawer} name="more" title=${texts.more} texts=${texts}>${part(texts.commands, html`<fieldset disabled=${isOld}><${More} zone=${zone} zones=${zones} texts=${texts} session=${session} /></fieldset>`)}<//>
        ${isInstruction ? null : asked ? html`<section class="dock"><${Command} label=${ask[1].label} small=${zone.todo} isMain act=${open} /></section>`
          : part("→", html`<${Dock} zone=${zone} texts=${texts} isOld=${isOld} />`)}
      </div>`}
    </div>`;
}

// What was refused or needs the reader stays in sight above the next action.
function Alerts({texts}) {
  const {marks} = state;
  return html`
    <div class="alerts">
      ${marks.refused.map((mark) => html`<${RefusedMark} key=${mark.id} mark=${mark} marks=${marks} texts=${texts} />`)}
    </div>`;
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
      hold(button, meaning, !before);
    }
  }
}
function hold(button, meaning, isNew = true) {
  clearTimeout((meanings.get(button) || {}).timer);
  button.dataset.changed = "changed";
  meanings.set(button, {meaning, timer: setTimeout(() => delete button.dataset.changed, button.matches(".next") && isNew ? NEXT_MS : CHANGED_MS)});
}
// Whatever drew it: a part of the page may draw itself, such as a sheet that was asked for.
new MutationObserver(holdChanged).observe(place, {subtree: true, childList: true, characterData: true});
window.addEventListener("pointerdown", () => (state.touchedAt = performance.now()), true);
place.addEventListener("click", (event) => {
  const held = event.target.closest("[data-changed]");
  if (held) {
    event.preventDefault();
    event.stopPropagation();
    hold(held, meanings.get(held).meaning);  // whoever touches again and again waits for nothing to begin
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
      <section class="alone">
        <h1>${texts.not_paired}</h1>
        <p class="quiet">${texts.pair_how}</p>
        <p><a class="button next" href=${address("/pair")}>${texts.pair_title}</a></p>
      </section>`;
  }
  if (state.isEnded) {
    return html`<h1 class="title" role="status">${texts.box_ended}</h1><p class="nothing">${texts.box_ended_how}</p>`;
  }
  const isOld = live.silentSince !== null || !zone;
  document.body.classList.toggle("old", isOld);
  const zones = session.zone ? null : data["page.zones"];
  const late = waitingText(marks, texts);
  const trouble = marks.refused.length > 0 ? refusedText(marks.refused[0], texts) : late ? late
    : !zone && live.silentSince === null ? noZone(texts) : "";
  strip.note(trouble || (live.silentSince === null ? state.gone || state.said || stopText(zone, texts) : texts.not_current),
    Boolean(trouble || state.gone) || isOld);
  const part = (name, made) => html`<${Guard} key=${name} name=${name}>${made}<//>`;
  return html`
    ${part("⚠", html`<${Urgent} zone=${zone} zones=${zones} />`)}
    ${part("!", html`<${Alerts} texts=${texts} />`)}
    ${zones && state.isChoosing && part("…", html`<${Zones} zones=${zones} texts=${texts} />`)}
    ${IS_BOX && part("nav", html`<${Nav} session=${session} part=${state.part} open=${openPart} texts=${texts} zones=${zones} />`)}
    ${zone && state.part !== OWN ? html`
      <fieldset disabled=${isOld} class="all whole">${part(texts[`part_${state.part}`], html`
        <${Part} key=${state.part} part=${state.part} data=${data[`part.${state.part}`]} zone=${zone} zones=${data["page.zones"]}
          session=${session} texts=${texts} marks=${marks} give=${give} undo=${(last) => undo(last, texts)}
          openZone=${openInZone} ended=${ended} />`)}</fieldset>` : zone
      ? part(texts.zone, html`<${ZonePage} key=${zone.zone} zone=${zone} zones=${zones} session=${session} texts=${texts} isOld=${isOld} />`)
      : html`<p class="nothing">${live.silentSince === null ? noZone(texts) : words.waiting}</p>`}`;
}

// Whom STOP reaches.
const stopText = ({phase, robot}, texts) => phase !== "running" ? "" : robot ? texts.stop_reaches.replace("{robot}", () => robot) : texts.stop_ends;

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
