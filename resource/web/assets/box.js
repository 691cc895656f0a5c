// The parts of the page of the whole box (docs/web.md, "The whole box"). Each is drawn, and its document sent, only while
// it is open. STOP is in stop.js.

import {Icon, address, columnsWithValues, html, useEffect, useRef, useState} from "/assets/parts.js";
import {reasonsText, roleText} from "/assets/device.js";
import {send} from "/assets/commands.js";
import {Twice} from "/assets/buttons.js";
import {Log} from "/assets/log.js";
import {DayEdits} from "/assets/day.js";
import {Devices} from "/assets/devices.js";
import {Pairings} from "/assets/pairings.js";
import {Facts} from "/assets/captain.js";
import {FinishedRun} from "/assets/runs.js";

const ALARM_HZ = 550;

// Zones beside each other, what waits for somebody, what comes next, and how the teams stand.
function Overview({data, zone, texts, openZone}) {
  const calling = data.zones.filter((one) => one.is_urgent).map((one) => `${one.zone} ${one.todo}`).join("\n");
  const known = useRef(calling);
  useEffect(() => {
    if (calling && calling !== known.current) {
      window.strip.signal(ALARM_HZ, [200]);
    }
    known.current = calling;
  }, [calling]);
  return html`
    <div class="zones">${data.zones.map((one) => html`
      <button type="button" key=${one.zone} class="zone" data-zone=${one.zone} data-meaning=${one.zone}
          aria-current=${zone && one.zone === zone.zone ? "true" : undefined} onClick=${() => openZone(one.zone)}>
        <span class="band ${one.look}">
          <strong>${one.zone}: ${one.team}</strong>
          <span class="chip"><${Icon} name=${one.look} solid=${one.look === "executing"} /> ${[one.phase_text, one.clock.pause].filter(Boolean).join(" · ")}</span>
          <span class="clock ${one.clock.main.hurry ? "hurry" : ""}">${one.clock.main.text}</span>
          <span class="progress" style="--part: ${one.clock.part}"></span>
        </span>
        <span class="facts">
          <span><${Icon} name="rules" /> ${one.event}</span>
          <span class=${one.is_urgent ? "urgent" : ""}><${Icon} name=${one.is_urgent ? "warning" : "robot"} /> ${one.todo} ${one.more}</span>
          <span><${Icon} name="referee" /> ${one.people || texts.no_phone}</span>
          <span><${Icon} name="organise" /> ${one.next ? html`<b class=${one.next.late ? "delay" : ""}>${one.next.begins || one.next.when}</b> ${
            one.next.team}, ${one.next.event} <span class="delay">${one.next.late}</span>` : texts.no_more_events}</span>
        </span>
      </button>`)}</div>
    <div class="work">
      <${Pane} name=${texts.part_schedule} more=${html`<button type="button" class="button" onClick=${() => openZone("", "schedule")}>${texts.choose_or_filter}</button>`}>
        ${data.coming.length === 0 ? html`<p class="nothing">${texts.nothing_to_come}</p>` : html`
          <table class="table schedule"><thead><tr>${texts.schedule_columns.map((column) => html`<th scope="col">${column}</th>`)}</tr></thead>
            <tbody>${data.coming.map((event) => html`
              <tr key=${event.id} class=${event.current ? "current" : ""}>
                <td><b>${event.begins || event.when}</b></td><td class="quiet">${event.when}</td><td><b>${event.team}</b></td>
                <td>${event.event}</td><td>${event.zone}</td><td><${State} event=${event} /></td></tr>`)}</tbody></table>`}
      <//>
      <div class="side">
        <${Pane} name=${texts.waits}>
          ${data.open.length === 0 ? html`<p class="nothing">${texts.nothing_open}</p>` : html`
            <ul class="rows">${data.open.map((one) => html`
              <li key=${one.what}><span class="count">${one.count}</span><span>${one.what}<small>${one.more}</small></span>
                <button type="button" class="button" aria-label="${texts.look_at}: ${one.what}" onClick=${() => openZone(one.zone, one.part)}>${texts.look_at}</button></li>`)}
            </ul>`}
        <//>
        <${Standings} standings=${data.standings} texts=${texts} />
      </div>
    </div>`;
}

const Pane = ({name, more, children}) => html`
  <section class="pane" aria-label=${name}><header><h2>${name}</h2>${more}</header>${children}</section>`;

// The state of an event, or how late it is.
const State = ({event}) => html`
  <span class="chip ${event.look}">${event.state}</span>${event.late && html` <span class="chip warning"><${Icon} name="late" /> ${event.late}</span>`}`;

// A standing without the columns in which nobody has anything.
function withValues(columns, rows) {
  const places = columnsWithValues(columns, rows.map((row) => row.slice(2)));
  return [places.map((place) => columns[place]), rows.map((row) => [...row.slice(0, 2), ...places.map((place) => row[place + 2])])];
}

function Standings({standings, texts}) {
  return html`
    <${Pane} name=${texts.standings}>
      ${standings.length === 0 && html`<p class="nothing">${texts.no_standings}</p>`}
      ${standings.map(({title, columns, rows, notes}) => [title, notes, ...withValues(columns, rows)]).map(([title, notes, columns, rows]) => html`
        <div class="scrolled" tabindex="0" key=${title}><table class="table"><caption>${title}</caption>
          <thead><tr><th scope="col">#</th><th scope="col">${texts.team}</th>${columns.map((column) => html`<th scope="col" class="number">${column}</th>`)}</tr></thead>
          <tbody>${rows.map(([rank, team, ...numbers]) => html`
            <tr key=${team}><td>${rank}</td><td><b>${team}</b></td>${numbers.map((one) => html`<td class="number">${one || "–"}</td>`)}</tr>`)}
          </tbody></table></div>
        ${notes.map((note) => html`<p class="facts">* ${note}</p>`)}`)}
    <//>`;
}

const ALL = "";

// Chooses one of some texts, or all.
function Filter({label, all, value, choices, set}) {
  return html`
    <label>${label}<select value=${value} onChange=${(event) => set(event.target.value)}>
      ${all && html`<option value=${ALL}>${all}</option>`}${choices.map(([name, text]) => html`<option key=${name} value=${name}>${text}</option>`)}
    </select></label>`;
}

function Schedule({data, texts, give, session}) {
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
    <div class=${session.role === "organiser" ? "beside" : ""}>
    ${session.role === "organiser" && html`<${Pane} name=${texts.day_title}><${DayEdits} texts=${texts} revision=${events.map(({id, when, state}) => id + when + state).join()} /><//>`}
    <${Pane} name=${texts.part_schedule} more=${html`<p class="facts">${data.summary}${data.hidden > 0 && ` · ${texts.hidden.replace("{number}", () => data.hidden)}`}</p>`}>
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
            <span class="when"><span>${event.when}</span>${event.begins && event.begins !== event.when && html` <small>${event.begins}</small>`}${event.late && html` <small class="delay">${event.late}</small>`}</span>
            <span><strong>${event.team}</strong> ${event.event}</span>
            <span>${event.zone}</span>
            <span><span class="chip ${event.look}">${event.state}</span> ${[event.score, event.sheet].filter(Boolean).join(" · ")}</span>
          </button>
          ${chosen === event.id && html`
            <div class="choose">
              ${isLeft && html`<p class="alarm">${texts.leave_unsigned.replace("{run}", () => left.name)} ${left.score}</p>`}
              ${data.leaving[event.zone] && !event.off && html`<p class="alarm">${data.leaving[event.zone]}</p>`}
              <${Twice} key="${event.id} ${isLeft && left.id}" name="choose_event" label=${texts.choose_event} question=${texts.really}
                reasons=${event.off ? [event.off] : []} act=${() => choose(event)} />
            </div>`}
        </li>`;
    })}</ul><//></div>`;
}

function Robots({data, texts, session, zone, zones}) {
  return html`
    <div class="columns">
      <${Pane} name=${texts.part_robots} more=${session.role === "organiser" && html`<a class="button" href=${address("/codes")}>${texts.codes}</a>`}>
        <${Heard} data=${data} texts=${texts} /><//>
      ${session.role === "organiser" && html`<${Pane} name=${texts.part_pairings}><${Pairings} zone=${zone} zones=${zones} texts=${texts} /><//>`}
    </div>`;
}

function Heard({data, texts}) {
  return data.robots.length === 0 ? html`<p class="nothing">${texts.no_robot}. ${texts.no_robot_how}</p>` : html`
    <div class="scrolled" tabindex="0"><table class="table robots"><thead><tr>${texts.robot_columns.map((column) => html`<th scope="col">${column}</th>`)}</tr></thead>
      <tbody>${data.robots.map((one) => html`
        <tr key=${one.slice(0, 2).join()}>${one.map((cell, column) => html`<td>${column ? cell : html`<strong>${cell}</strong>`}</td>`)}</tr>`)}
      </tbody></table></div>
    <p class="facts">${texts.robot_explanations.join(" ")}</p>
    ${data.hidden > 0 && html`<p class="facts">${texts.hidden.replace("{number}", () => data.hidden)}</p>`}`;
}

function Runs({data, zone, texts, marks, undo, give, ...rest}) {
  return html`
    <div class="columns">
      <${Pane} name="${texts.part_runs}: ${zone.zone}" more=${html`<${OfZone} part="runs" zone=${zone} texts=${texts} ...${rest} />`}>
        ${data.runs.length === 0 && html`<p class="nothing">${texts.no_runs} ${texts.no_runs_how}</p>`}
        <ul class="unsigned">${data.runs.map((run) => html`
          <${FinishedRun} key=${run.identity} zone=${zone} run=${run} marks=${marks} texts=${texts} give=${give} undo=${undo}
            events=${data.events[run.code]} />`)}</ul>
        ${data.hidden > 0 && html`<p class="facts">${texts.hidden.replace("{number}", () => data.hidden)}</p>`}
      <//>
      <${Standings} standings=${data.standings} texts=${texts} />
    </div>`;
}

function LogOfZone({data, zone, texts, ...rest}) {
  return html`<${Pane} name="${texts.part_log}: ${zone.zone}" more=${html`<${OfZone} part="log" zone=${zone} texts=${texts} ...${rest} />`}>
    <${Log} data=${data} texts=${texts} /><//>`;
}

// Another zone of a part that shows one.
const OfZone = ({part, zone, zones, session, texts, openZone}) => !session.zone && (zones || []).length > 1 && html`
  <${Filter} label=${texts.zone} value=${zone.zone} choices=${zones.map((one) => [one.zone, one.zone])} set=${(name) => openZone(name, part)} />`;

function Box({data, texts, session, give, ended}) {
  return html`
    <div class="columns">
      <${Pane} name=${texts.part_box}>
        <div role="status">
          ${data.status && html`<p class="banner ${data.is_ok ? "" : "warning"}">${data.status}</p>`}
          ${data.warnings.map((text) => html`<p key=${text} class="banner warning"><${Icon} name="warning" /> ${text}</p>`)}
        </div>
        <${Facts} lines=${data.facts} />
        <h3>${texts.tablet}</h3>
        ${data.tablet ? html`<${Facts} lines=${data.tablet} />` : html`<p class="nothing">${texts.no_tablet}</p>`}
        ${session.role === "organiser" && html`<${Exit} runs=${data.runs} texts=${texts} give=${give} ended=${ended} />`}
      <//>
      ${session.role === "organiser" && html`
        <${Pane} name=${texts.reload_title}><${Reload} texts=${texts} /><//>
        <${Pane} name=${texts.part_devices}><${Devices} texts=${texts} give=${give} /><//>`}
    </div>`;
}

// Ends the box, after a question that names the runs in progress.
function Exit({runs, texts, give, ended}) {
  const [isAsking, setAsking] = useState(false);
  const view = useRef(null);
  useEffect(() => isAsking && view.current.scrollIntoView({block: "center"}), [isAsking]);  // above STOP
  const exit = async () => {
    const isDone = await give("exit", texts, texts.exit, {anyway: runs !== ""});
    isDone ? ended() : setAsking(false);
  };
  return html`
    <section class="exit" ref=${view}>${isAsking ? html`
      <h2>${texts.exit_title}</h2>
      <p>${texts.exit_all}</p>
      ${runs && html`<p class="alarm">${texts.exit_runs.replace("{runs}", () => runs)}</p>`}
      <div class="controls"><button type="button" class="button" data-command="exit" onClick=${exit}>${texts.exit_now}</button>
        <button type="button" class="button" onClick=${() => setAsking(false)}>${texts.cancel}</button></div>` : html`
      <div class="controls"><button type="button" class="button" data-command="ask_exit" onClick=${() => setAsking(true)}>${texts.exit} …</button></div>`}
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
      ${!found && html`<p class="nothing">${texts.reload_how}</p>`}
      ${found && html`<p class=${found.isWrong ? "alarm" : "todo"} role="status">${found.said}</p>
        <ul class="lines">${found.lines.map((line) => html`<li>${line}</li>`)}</ul>
        ${found.forAll && html`<p>${texts.reload_rescored}</p>
          <ul class="lines">${found.rescored.map((line) => html`<li>${line}</li>`)}</ul>`}`}
      <div class="controls">
        <button type="button" class="button" data-command="reload" onClick=${() => ask("")}>${texts.reload}</button>
        ${found && found.apply && html`<button type="button" class="button next" data-command="apply" onClick=${() => ask(found.apply)}>${texts.apply}</button>`}
        ${found && found.forAll && html`<button type="button" class="button" data-command="apply_to_all" onClick=${() => ask(found.forAll, true)}>${texts.reload_for_all}</button>`}
      </div>
    </section>`;
}

// Each part with its icon, in the order of the tabs. The zone's own page is that of the referee.
const PARTS = {overview: [Overview, "now"], zone: [null, "zone"], schedule: [Schedule, "organise"], runs: [Runs, "results"],
  robots: [Robots, "team"], log: [LogOfZone, "timeline"], box: [Box, "box"]};
export const isSent = (part) => Boolean(PARTS[part]) && part !== "zone";

// The parts that a device may open.
export const partsOf = (session) => session.role === "judge" ? ["zone"]
  : Object.keys(PARTS).filter((part) => session.role === "organiser" || part !== "overview");

export function Nav({session, part, open, texts, zones}) {
  const parts = partsOf(session), calling = (zones || []).filter((one) => one && one.is_urgent && !session.zone);
  useEffect(() => {
    document.body.dataset.shows = part;
  }, [part]);
  return parts.length > 1 && html`
    <nav class="tabs" aria-label=${texts.whole_box}>${parts.map((one) => html`
      <button type="button" key=${one} data-part=${one} data-meaning=${one} aria-current=${one === part ? "page" : undefined}
        class=${one === "overview" && calling.length > 0 ? "urgent" : ""} onClick=${() => open(one)}>
        <${Icon} name=${one === "overview" && calling.length > 0 ? "warning" : PARTS[one][1]} /> <span>${texts[`part_${one}`]}</span></button>`)}
      ${session.role === "organiser" && html`<a href=${address("/displays")}><${Icon} name="screens" /> <span>${texts.displays}</span></a>`}
      <a class="person" href=${address("/pair")}><${Icon} name="referee" /> <span>${session.person} · ${roleText(session, texts)}</span></a></nav>`;
}

export function Part({part, data, ...rest}) {
  const [Shown] = PARTS[part];
  return html`
    <section class="part"><h1 class="unseen">${rest.texts[`part_${part}`]}</h1>${data && html`<${Shown} data=${data} ...${rest} />`}</section>`;
}
