// The parts of the page of the whole box (docs/web.md, "The whole box"). Each is drawn, and its document sent, only while
// it is open. STOP is in stop.js.

import {address, html, useEffect, useRef, useState} from "/assets/parts.js";
import {reasonsText} from "/assets/device.js";
import {send} from "/assets/commands.js";
import {Twice} from "/assets/buttons.js";
import {Log} from "/assets/log.js";
import {Devices} from "/assets/devices.js";
import {Pairings} from "/assets/pairings.js";
import {Facts, FinishedRun} from "/assets/runs.js";

const ALARM_HZ = 550;

function Overview({data, zone, openZone}) {
  const calling = data.zones.filter((one) => one.is_urgent).map((one) => `${one.zone} ${one.todo}`).join("\n");
  const known = useRef(calling);
  useEffect(() => {
    if (calling && calling !== known.current) {
      window.strip.signal(ALARM_HZ, [200]);
    }
    known.current = calling;
  }, [calling]);
  return html`
    <div class="tiles">${data.zones.map((one) => html`
      <button type="button" key=${one.zone} class="tile ${one.phase}" data-zone=${one.zone} data-meaning=${one.zone}
          aria-current=${zone && one.zone === zone.zone ? "true" : undefined} onClick=${() => openZone(one.zone)}>
        <strong class="short">${one.zone}</strong>
        <span class="time ${one.clock.main.hurry ? "hurry" : ""}">${one.clock.main.text}</span>
        <span class="short wide">${one.team} · ${one.event}</span>
        <span class="phase short wide">${[one.phase_text, one.clock.pause].filter(Boolean).join(" · ")}</span>
        <span class="task wide ${one.is_urgent ? "urgent" : ""}">${one.is_urgent && "⚠ "}${one.todo} ${one.more}</span>
      </button>`)}</div>`;
}

const ALL = "";

// Chooses one of some texts, or all.
function Filter({label, all, value, choices, set}) {
  return html`
    <label>${label}<select value=${value} onChange=${(event) => set(event.target.value)}>
      <option value=${ALL}>${all}</option>${choices.map(([name, text]) => html`<option key=${name} value=${name}>${text}</option>`)}
    </select></label>`;
}

function Schedule({data, texts, give}) {
  const [wanted, setWanted] = useState({zone: ALL, team: ALL, day: ALL, show: ALL});
  const [chosen, setChosen] = useState("");
  const {events} = data;
  const names = (field) => [...new Set(events.map((event) => event[field]))].sort().map((name) => [name, name]);
  const set = (field) => (value) => setWanted((before) => ({...before, [field]: value}));
  const shown = events.filter((event) => [ALL, event.zone].includes(wanted.zone) && [ALL, event.team].includes(wanted.team)
    && [ALL, event.day].includes(wanted.day) && (wanted.show === ALL || event.shows.includes(wanted.show)));
  const zones = names("zone"), days = names("day");
  const choose = async (event) => {
    const left = data.left[event.zone];
    if (await give("choose_event", texts, texts.choose_event, {zone: event.zone, identity: "", event_id: "",
      given: {event: event.id, team: event.team, unsigned: Boolean(left)}})) {
      setChosen("");
    }
  };
  return html`
    <p class="facts">${data.summary}${data.hidden > 0 && ` · ${texts.hidden.replace("{number}", () => data.hidden)}`}</p>
    <div class="filters">
      ${zones.length > 1 && html`<${Filter} label=${texts.zone} all=${texts.all_zones} value=${wanted.zone} choices=${zones} set=${set("zone")} />`}
      <${Filter} label=${texts.team} all=${texts.all_teams} value=${wanted.team} choices=${names("team")} set=${set("team")} />
      ${days.length > 1 && html`<${Filter} label=${texts.day} all=${texts.all_days} value=${wanted.day} choices=${days} set=${set("day")} />`}
      <${Filter} label=${texts.show} all=${texts.all_events} value=${wanted.show} choices=${texts.schedule_shows} set=${set("show")} />
    </div>
    ${shown.length === 0 && html`<p class="nothing">${texts.no_events}</p>`}
    <ul class="events">${shown.map((event) => {
      const left = data.left[event.zone], isLeft = left && left.id !== event.id && !event.off;
      return html`
        <li key=${event.id} class="event ${event.current ? "current" : ""}" data-event=${event.id}>
          <button type="button" aria-expanded=${chosen === event.id} data-meaning=${event.id}
              onClick=${() => setChosen(chosen === event.id ? "" : event.id)}>
            <span class="when"><span>${event.when}</span>${event.begins && event.begins !== event.when && html` <small>${event.begins}</small> <small>${event.late}</small>`}</span>
            <span><strong>${event.team}</strong> ${event.event}</span>
            <span>${event.zone}</span>
            <span>${event.current && "◆ "}${event.state}${event.score && ` · ${event.score}`}${event.sheet && ` · ${event.sheet}`}</span>
          </button>
          ${chosen === event.id && html`
            <div class="choose">
              ${isLeft && html`<p class="alarm">${texts.leave_unsigned.replace("{run}", () => left.name)} ${left.score}</p>`}
              ${data.leaving[event.zone] && !event.off && html`<p class="alarm">${data.leaving[event.zone]}</p>`}
              <${Twice} key="${event.id} ${isLeft && left.id}" name="choose_event" label=${texts.choose_event} question=${texts.really}
                reasons=${event.off ? [event.off] : []} act=${() => choose(event)} />
            </div>`}
        </li>`;
    })}</ul>`;
}

function Robots({data, texts}) {
  return data.robots.length === 0 ? html`<p class="nothing">${texts.no_robot}</p>` : html`
    <div class="scrolled" tabindex="0"><table><thead><tr>${texts.robot_columns.map((column) => html`<th scope="col">${column}</th>`)}</tr></thead>
      <tbody>${data.robots.map((one) => html`
        <tr key=${one.slice(0, 2).join()}>${one.map((cell, column) => html`<td>${column ? cell : html`<strong>${cell}</strong>`}</td>`)}</tr>`)}
      </tbody></table></div>
    <p class="facts">${texts.robot_explanations.join(" ")}</p>
    ${data.hidden > 0 && html`<p class="facts">${texts.hidden.replace("{number}", () => data.hidden)}</p>`}`;
}

function Runs({data, zone, texts, marks, undo, give}) {
  return html`
    ${data.runs.length === 0 && html`<p class="nothing">${texts.no_runs}</p>`}
    <ul class="unsigned">${data.runs.map((run) => html`
      <${FinishedRun} key=${run.identity} zone=${zone} run=${run} marks=${marks} texts=${texts} give=${give} undo=${undo} />`)}</ul>
    ${data.hidden > 0 && html`<p class="facts">${texts.hidden.replace("{number}", () => data.hidden)}</p>`}`;
}

function Box({data, texts, session, give, ended}) {
  return html`
    <div role="status">
      ${data.status && html`<p class="todo ${data.is_ok ? "" : "urgent"}">${data.status}</p>`}
      <ul class="warnings">${data.warnings.map((text) => html`<li key=${text}>⚠ ${text}</li>`)}</ul>
    </div>
    <${Facts} lines=${data.facts} />
    <h2>${texts.tablet}</h2>
    ${data.tablet ? html`<${Facts} lines=${data.tablet} />` : html`<p class="nothing">${texts.no_tablet}</p>`}
    ${session.role === "organiser" && html`
      <${Reload} texts=${texts} />
      <p class="controls"><a class="button" href=${address("/displays")}>${texts.displays}</a>
        <a class="button" href=${address("/codes")}>${texts.codes}</a></p>
      <${Exit} runs=${data.runs} texts=${texts} give=${give} ended=${ended} />`}`;
}

// Ends the box, after a question that names the runs in progress.
function Exit({runs, texts, give, ended}) {
  const [isAsking, setAsking] = useState(false);
  useEffect(() => isAsking && scrollTo(0, document.documentElement.scrollHeight), [isAsking]);  // above STOP
  const exit = async () => {
    const isDone = await give("exit", texts, texts.exit, {anyway: runs !== ""});
    isDone ? ended() : setAsking(false);
  };
  return html`
    <section class="exit">${isAsking ? html`
      <h2>${texts.exit_title}</h2>
      <p>${texts.exit_all}</p>
      ${runs && html`<p class="alarm">${texts.exit_runs.replace("{runs}", () => runs)}</p>`}
      <div class="controls"><button type="button" data-command="exit" onClick=${exit}>${texts.exit_now}</button>
        <button type="button" onClick=${() => setAsking(false)}>${texts.cancel}</button></div>` : html`
      <div class="controls"><button type="button" data-command="ask_exit" onClick=${() => setAsking(true)}>${texts.exit} …</button></div>`}
    </section>`;
}

// What the configuration files change, and then: apply it.
function Reload({texts}) {
  const [found, setFound] = useState(null);
  const ask = async (digest, forAll = false) => {
    setFound({said: `${texts.reload} …`, lines: []});
    const {status, body, ...rest} = await send("reload", {digest, for_all: forAll});
    const isOpen = status === 200 && !body.applied;
    const apply = isOpen && body.changes.length > 0 ? body.digest : "";
    const said = status !== 200 ? reasonsText({status, body, ...rest}, texts) : body.errors.length > 0 ? texts.reload_errors
      : body.applied ? texts.reload_done : apply ? texts.reload_apply : texts.reload_same;
    setFound({said, isWrong: status !== 200 || body.errors.length > 0, lines: status !== 200 ? [] : body.errors.length > 0 ? body.errors
      : [...body.changes, ...body.warnings.map((line) => `⚠ ${line}`)], apply: status === 200 && body.errors.length === 0 && apply,
      forAll: isOpen && body.errors.length === 0 && body.rescored.length > 0 && body.digest, rescored: isOpen ? body.rescored : []});
  };
  return html`
    <section class="reload">
      <h2>${texts.reload_title}</h2>
      ${found && html`<p class=${found.isWrong ? "alarm" : "todo"} role="status">${found.said}</p>
        <ul class="lines">${found.lines.map((line) => html`<li>${line}</li>`)}</ul>
        ${found.forAll && html`<p>${texts.reload_rescored}</p>
          <ul class="lines">${found.rescored.map((line) => html`<li>${line}</li>`)}</ul>`}`}
      <div class="controls">
        <button type="button" data-command="reload" onClick=${() => ask("")}>${texts.reload}</button>
        ${found && found.apply && html`<button type="button" class="main" data-command="apply" onClick=${() => ask(found.apply)}>${texts.apply}</button>`}
        ${found && found.forAll && html`<button type="button" data-command="apply_to_all" onClick=${() => ask(found.forAll, true)}>${texts.reload_for_all}</button>`}
      </div>
    </section>`;
}

// Each part, in the order of their buttons. The first is the zone's own page. Some ask for what they show themselves.
const PARTS = {zone: null, overview: Overview, schedule: Schedule, robots: Robots, devices: Devices, runs: Runs, log: Log, box: Box,
  pairings: Pairings};
const ASKING = ["devices", "pairings"], OF_ORGANISERS = ["overview", ...ASKING];
export const isSent = (part) => Boolean(PARTS[part]) && !ASKING.includes(part);

// The parts that a device may open.
export const partsOf = (session) => session.role === "judge" ? ["zone"]
  : Object.keys(PARTS).filter((part) => session.role === "organiser" || !OF_ORGANISERS.includes(part));

export function Nav({session, part, open, texts}) {
  const parts = partsOf(session);
  return parts.length > 1 && html`
    <nav class="parts">${parts.map((one) => html`
      <button type="button" key=${one} class="short" data-part=${one} data-meaning=${one} aria-current=${one === part ? "page" : undefined}
        onClick=${() => open(one)}>${texts[`part_${one}`]}</button>`)}</nav>`;
}

export function Part({part, data, ...rest}) {
  return html`
    <section class="part"><h1 class="unseen">${rest.texts[`part_${part}`]}</h1>
      ${(data || !isSent(part)) && html`<${PARTS[part]} data=${data} ...${rest} />`}</section>`;
}
