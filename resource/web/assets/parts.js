// Parts that several pages share.

import {Component, html, render, useEffect, useLayoutEffect, useRef, useState} from "/assets/vendor/preact-htm.js";
import {Live} from "/assets/live.js";

export {Component, html, useEffect, useLayoutEffect, useRef, useState};

export const parameters = new URLSearchParams(location.search);
// A long text shrinks to at most this share of its size. Then it is shortened: it must stay legible.
const SMALLEST = 0.7;
const DOCUMENTS = ["page.words", "page.runs", "page.next", "page.results", "page.standings"];
export const EXPLAINED = "page.explained";
const DEVICE_WORDS = "page.device_words";
const {strip} = window;  // STOP, on a paired device: see stop.js
const RESIZED_MS = 1000;
const LOGO_AGAIN_MS = 15000;
const DISPLAYS = "roah_rsbb_displays", DISPLAY_NAME = "roah_rsbb_display_name";

// What the organiser has set for this display. A field that is null is as the address of the page says.
let central = {};
export const caption = () => central.caption || "";

// Show a page: `Page` gets the live data and the texts of the language. `display`: its name in the organiser's list.
// Until its first message has come, what the server has written stays.
export function show(Page, documents = DOCUMENTS, display = "") {
  const place = document.getElementById("page");
  const query = () => ({
    documents: [...new Set([...documents, ...(strip ? [DEVICE_WORDS] : [])])].join(","), language: central.language || parameters.get("language") || navigator.languages.join(","),
    ...(display && {page: display, ...identity(), size: `${innerWidth}x${innerHeight}`, show: parameters.get("show") || ""}),
  });
  const open = () => [...Object.entries(query()), ...(display ? parameters.getAll("zone").map((zone) => ["zone", zone]) : [])];
  const draw = () => {
    strip && live.data[DEVICE_WORDS] && strip.speak(live.data[DEVICE_WORDS], () => null);
    const words = live.data["page.words"];
    if (words && (live.data["page.runs"] || !documents.includes("page.runs"))) {
      place.firstElementChild && place.firstElementChild.matches(".first") && place.firstElementChild.remove();
      document.documentElement.lang = words.language;
      document.body.classList.toggle("old", live.silentSince !== null);
      render(html`
        <${Page} live=${live} words=${words} />
        ${central.shows_name && html`<p class="identify" role="status">${central.name}</p>`}`, place);
    }
  };
  const changed = () => {
    const before = central.language || null;
    central = live.data["page.display"] || {};
    if ((central.language || null) !== before) {
      live.reopen(open());
    }
    draw();
  };
  const live = new Live("events", open(), changed);
  // Lines that fit in another typeface may not fit in ours.
  document.fonts.addEventListener("loadingdone", () => document.body.dataset.layout !== "list" && draw());
  let resized;
  window.addEventListener("resize", () => {
    draw();
    clearTimeout(resized);
    resized = display && setTimeout(() => live.reopen(open()), RESIZED_MS);
  });
  window.live = live;  // for the browser's console, and for tests
}

// The identity of this display, which its browser keeps. Several windows of a browser differ by ?name=…
function identity() {
  const name = parameters.get("name") || localStorage.getItem(DISPLAY_NAME) || "";
  const known = JSON.parse(localStorage.getItem(DISPLAYS) || "{}");
  if (!known[name]) {
    known[name] = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
    localStorage.setItem(DISPLAYS, JSON.stringify(known));
  }
  localStorage.setItem(DISPLAY_NAME, name);
  return {display: known[name], name};
}

// What a display shows: as the organiser has set, else as its address says.
export function shown() {
  return central.show || parameters.get("show") || "rotating";
}

// The zones that the organiser or the address chooses, as in ?zone=Home+A&zone=Home+B; all without one.
export function isChosen(line) {
  const isSet = typeof central.zone === "string";
  const zones = isSet ? [central.zone].filter(Boolean) : parameters.getAll("zone");
  return zones.length === 0 || zones.includes(line.zone);
}

// An address of ours with these parameters, and with the language of this page.
export function address(path, more = {}) {
  const query = new URLSearchParams(more);
  if (parameters.has("language")) {
    query.set("language", parameters.get("language"));
  }
  return query.toString() ? `${path}?${query}` : path;
}

// An icon of icons.svg, by its name there without "i-". The words beside it say the same.
export const Icon = ({name, solid = false}) => html`
  <svg class="icon ${solid ? "solid" : ""}" aria-hidden="true"><use href="/assets/icons.svg#i-${name}" /></svg>`;

// -- times --------------------------------------------------------------------------------------------

function two(number) {
  return String(number).padStart(2, "0");
}

// The time left as m:ss, or as h:mm:ss from an hour on.
export function countdown(seconds) {
  const whole = Math.max(0, Math.ceil(Math.round(seconds * 1000) / 1000));
  const minutes = Math.floor(whole / 60);
  const rest = `${two(whole % 60)}`;
  return minutes >= 60 ? `${Math.floor(minutes / 60)}:${two(minutes % 60)}:${rest}` : `${minutes}:${rest}`;
}

function bigText(run, now) {
  if (now === null || (run.ends === null && run.counts_from === null)) {
    return run.big;
  }
  return run.big.replace("{time}", countdown(run.ends === null ? Math.floor(now - run.counts_from) : run.ends - now));
}

export function clockText(now, words) {
  return now === null ? "" : new Date((now + words.utc_offset_s) * 1000).toISOString().slice(11, 19);
}

// What changes with time by itself. `make` returns it.
function useTicking(make) {
  const [, redraw] = useState("");
  useEffect(() => {
    const timer = setInterval(() => redraw(make()), 100);
    return () => clearInterval(timer);
  });
  return make();
}

export const Ticking = ({make, tag = "span", ...rest}) => html`<${tag} ...${rest}>${useTicking(make)}<//>`;

// Why the content may be out of date, or that it is a replay; empty: it is current.
export function troubleText(live, words) {
  if (live.silentSince === null || !live.data["page.runs"]) {
    return (live.data["page.runs"] || {}).replay || "";
  }
  return words.no_signal.replace("{time}", clockText(live.silentSince, words));
}

export const Trouble = ({text}) => text && html`
  <p class="banner warning trouble" role="alert"><${Icon} name="warning" /><span>${text}</span></p>`;

// -- runs ---------------------------------------------------------------------------------------------

// Lines that shrink until they fit: all at once, because the browser lays the page out before each look. Where the page
// has space for it, a name that would become too small takes two lines instead.
let lines = [];
const TWO_LINES = ".zone .team, .result .team";

function fit() {
  const range = document.createRange();
  lines.forEach((line) => {
    line.classList.remove("two");
    Object.assign(line.style, {fontSize: "", textOverflow: "clip"});  // the dots would count
  });
  const sizes = lines.map(() => 1);
  // Letters have whole pixels and do not shrink exactly: a line that is still too wide shrinks again.
  for (let tries = 0; tries < 3; tries += 1) {
    const shares = lines.map((line) => {
      range.selectNodeContents(line);
      return line.getBoundingClientRect().width / range.getBoundingClientRect().width;
    });
    lines.forEach((line, place) => {
      if (shares[place] < 1 && !line.classList.contains("two")) {
        sizes[place] *= 0.99 * shares[place];
        const isTwo = line.classList.toggle("two", sizes[place] < SMALLEST && line.closest(TWO_LINES) !== null);
        line.style.fontSize = isTwo ? "" : `${Math.max(SMALLEST, sizes[place])}em`;
      }
    });
  }
  lines.forEach(({style}) => Object.assign(style, {textOverflow: ""}));
  lines = [];
}

// A line that shrinks until it fits. In lists that scroll it wraps.
export function Fit({children, tag = "span", ...rest}) {
  const element = useRef(null);
  useLayoutEffect(() => {
    if (document.body.dataset.layout !== "list" && !element.current.closest(".copy") && lines.push(element.current) === 1) {
      queueMicrotask(fit);
    }
  });
  return html`<${tag} ...${rest}><span class="fit" ref=${element}>${children}</span><//>`;
}

// Two letters of a name: of its first words, or of its capitals.
export const initials = (name) => (name.match(/\p{Lu}\p{Ll}*|\p{L}+|\p{N}+/gu) || [name || "?"]).slice(0, 2)
  .map((word, place, all) => (all.length > 1 ? word.slice(0, 1) : word.slice(0, 2))).join("");

// The logo of a team, or its initials at the same size. A logo that did not come is tried again.
export function TeamMark({team, live}) {
  const [tries, setTries] = useState(0);
  const [isLoaded, setLoaded] = useState(false);
  const failed = () => {
    setLoaded(false);
    setTimeout(() => setTries(tries + 1), LOGO_AGAIN_MS);
  };
  return html`
    <span class="team-mark ${isLoaded ? "has-logo" : ""}" aria-hidden="true">
      ${isLoaded || initials(team)}
      ${live.data["page.words"].logos.includes(team) && html`
        <img key=${tries} hidden=${!isLoaded} alt="" src="/logos/${encodeURIComponent(team)}${tries ? `?${tries}` : ""}"
          onLoad=${() => setLoaded(true)} onError=${failed} />`}
    </span>`;
}

export const Clock = ({run, live, ...rest}) => html`
  <${Ticking} class="big" make=${() => bigText(run, live.now())} ...${rest} />`;

const SOLID = ["executing", "stopped"];
export const State = ({run, word = run.word}) => html`
  <span class="chip ${run.look} word"><${Icon} name=${run.is_paused ? "pause" : run.look} solid=${SOLID.includes(run.look)} />
    <span>${word}</span></span>`;

// How much of a run's time is used.
export function Progress({run, live}) {
  const part = useTicking(() => {
    const left = run.ends === null ? run.left_s : run.ends - live.now();
    return run.limit && left !== null ? Math.min(1, Math.max(0, 1 - left / run.limit)).toFixed(3) : 0;
  });
  return html`<div class="progress" style=${{"--part": part}}></div>`;
}

// The classes of the ground on which a run stands: its state.
export const band = (run) => `band ${run.look} ${run.is_paused ? "paused" : ""}`;

// A run: a field of colour with its team and its clock.
export const Zone = ({run, live}) => html`
  <article class="zone ${band(run)}" data-zone=${run.zone}>
    <${TeamMark} key=${run.team} team=${run.team} live=${live} />
    <div class="who">
      <${Fit} tag="h3" class="team">${run.team}<//>
      <${Fit} tag="p" class="benchmark">${run.benchmark}<//>
      <${Fit} tag="p" class="place">${run.place}<//>
    </div>
    <div class="when"><${Clock} run=${run} live=${live} /><${State} run=${run} /></div>
    <${Progress} run=${run} live=${live} />
  </article>`;

// -- lists --------------------------------------------------------------------------------------------

// A coming event or a result.
export function Line({line, scores = line.scores, isMore = false}) {
  return html`
    <li class="line ${line.look && "ended"}">
      ${!isMore && html`
        <div class="row">
          <${Fit} class="time"><b>${line.time}</b>${line.planned && html` <s>${line.planned}</s>`}<//>
          <${Fit} class="team">${line.team}<//>
          <${Fit} class="benchmark">${line.benchmark}<//>
          <span class="last">${line.look ? html`<${State} run=${line} word=${line.last} />` : line.last}
            ${line.points && html` <b class="points">${line.points}</b>`}</span>
        </div>`}
      ${scores.length > 0 && html`<div class="scores">${scores.map(([name, value]) => html`<span>${name} <b>${value}</b></span> `)}</div>`}
    </li>`;
}

// The rows of a standing: its teams, then what a reader must know of it.
export const ranksOf = ({ranks, notes}) => [...ranks, ...(notes.length ? [{note: `* ${notes.map(({note}) => note).join(" · ")}`}] : [])];

// A clock such as 2:41 in seconds; 0: none.
export const secondsOf = (text) => text.split(":").reduce((all, part) => 60 * all + (Number.parseInt(part, 10) || 0), 0);

// The places of the columns of a standing: without those in which nobody has anything. The first one decides, and stays.
export const columnsWithValues = (names, rows) => [...names.keys()]
  .filter((place) => place === 0 || rows.some((numbers) => !["", "0", "–"].includes(numbers[place] || "")));

// The columns of a standing, the one that decides at the end. A screen in the hall has space for few, and shows what decides.
const MOST_COLUMNS = 3;
function columns({criteria, ranks}) {
  const found = columnsWithValues(criteria, ranks.map(({numbers}) => numbers)).map((place) => [criteria[place], place]);
  const most = document.body.dataset.layout === "board" ? MOST_COLUMNS : criteria.length;
  return found.length > most ? found.slice(0, 1) : [...found.slice(1), ...found.slice(0, 1)];
}

// A standing, as a table.
export function Standing({standing, words, live, ranks = ranksOf(standing), current}) {
  const shownHere = columns(standing);
  return html`
    <table class="table standing">
      <thead><tr>
        <th scope="col">${words.rank}</th><th scope="col" class="team">${words.team}</th>
        ${shownHere.map(([name]) => html`<th scope="col" class="number">${name}</th>`)}
      </tr></thead>
      <tbody>${ranks.map(({rank, team, numbers, note}) => note ? html`
        <tr key=${note} class="note"><td colspan=${2 + shownHere.length}>${note}</td></tr>` : html`
        <tr key=${team} class="rank" aria-current=${team === current ? "true" : undefined}>
          <td><b>${rank}</b></td>
          <th scope="row" class="team"><span><${TeamMark} team=${team} live=${live} /><${Fit}>${team}<//></span></th>
          ${shownHere.map(([name, place]) => html`<td class="number" data-name=${name}>${numbers[place] || ""}</td>`)}
        </tr>`)}</tbody>
    </table>`;
}

// A run explained: what happens now, its steps, what it is about, and what the robot says.
function explanation(run) {
  const now = run.steps.some((step) => step.state === "now" && step.text === run.now) ? "" : run.now;
  const icons = {done: "check", now: "executing", later: "waiting"};
  return [
    (now || run.progress) && html`<li class="line now"><b>${now}</b> ${run.progress}</li>`,
    run.steps.length > 0 && html`
      <li class="line"><ol class="steps">${run.steps.map((step) => html`
        <li class=${step.state} aria-current=${step.state === "now" ? "step" : undefined}>
          <${Icon} name=${icons[step.state]} solid=${step.state === "now"} /> ${step.text}</li>`)}
      </ol></li>`,
    run.about && html`<li class="line">${run.about}</li>`,
    ...run.said.slice().reverse().map((text) => html`<li class="line quiet">${text}</li>`),
  ].filter(Boolean);
}

// All lists in the order in which they take turns: title, lines, blocks or a standing, and whether only the first page
// is shown.
export function lists(live, words, show = "rotating") {
  const {runs} = live.data["page.runs"], {standings} = live.data["page.standings"], results = live.data["page.results"];
  const following = live.data["page.next"].lines.filter(isChosen);
  const next = {title: words.next, lines: following, isFirst: show !== "schedule", nothing: words.schedule_is_done};
  const explained = live.data[EXPLAINED] ? live.data[EXPLAINED].runs.filter(isChosen).flatMap((run) => {
    const card = runs.find((one) => one.zone === run.zone);
    return card ? [{title: `${card.team} · ${card.benchmark}`, blocks: explanation(run)}] : [];
  }) : [];
  const ranked = standings.map((standing) => ({title: standing.title, standing}));
  const ended = [[words.results, "results"], [words.provisional, "provisional"]]
    .map(([title, name]) => ({title, lines: results[name].filter(isChosen)}))
    .filter(({lines}) => lines.length > 0);
  const nothing = (title, text) => [{title, lines: [], nothing: text}];
  return {
    run: explained.length > 0 ? explained : [next],
    schedule: [next],
    standings: ranked.length > 0 ? ranked : nothing(words.standings, words.no_standings),
    results: ended.length > 0 ? ended : nothing(words.results, words.no_results),
  }[show] || [...explained, next, ...ranked, ...ended];
}
