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
const DISPLAYS = "roah_rsbb_displays", DISPLAY_NAME = "roah_rsbb_display_name";

// What the organiser has set for this display. A field that is null is as the address of the page says.
let central = {};

// Show a page: `Page` gets the live data and the texts of the language. `display`: its name in the organiser's list.
export function show(Page, documents = DOCUMENTS, display = "") {
  const place = document.getElementById("page");
  const query = () => ({
    documents: [...new Set([...documents, ...(strip ? [DEVICE_WORDS] : [])])].join(","), language: central.language || parameters.get("language") || navigator.languages.join(","),
    ...(display && {page: display, ...identity(), size: `${innerWidth}x${innerHeight}`, show: parameters.get("show") || ""}),
  });
  const open = () => [...Object.entries(query()), ...(display ? parameters.getAll("zone").map((zone) => ["zone", zone]) : [])];
  const draw = () => {
    strip && live.data[DEVICE_WORDS] && strip.speak(live.data[DEVICE_WORDS], () => null);
    render(html`<${Whole} page=${Page} live=${live} />`, place);
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
  let resized;
  window.addEventListener("resize", () => {
    draw();
    clearTimeout(resized);
    resized = display && setTimeout(() => live.reopen(open()), RESIZED_MS);
  });
  window.live = live;  // for the browser's console, and for tests
  draw();
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

function Whole({page, live}) {
  const words = live.data["page.words"];
  if (!words) {
    return null;
  }
  document.documentElement.lang = words.language;
  document.body.classList.toggle("old", live.silentSince !== null);
  return html`
    <${page} live=${live} words=${words} />
    ${central.shows_name && html`<p class="identify" role="status">${central.name}</p>`}`;
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

export function bigText(run, now) {
  if (now === null || (run.ends === null && run.counts_from === null)) {
    return run.big;
  }
  return run.big.replace("{time}", countdown(run.ends === null ? Math.floor(now - run.counts_from) : run.ends - now));
}

export function clockText(now, words) {
  return now === null ? "" : new Date((now + words.utc_offset_s) * 1000).toISOString().slice(11, 19);
}

// A text that changes with time by itself. `make` returns it.
export function Ticking({make, tag = "span", ...rest}) {
  const [, redraw] = useState("");
  useEffect(() => {
    const timer = setInterval(() => redraw(make()), 100);
    return () => clearInterval(timer);
  });
  return html`<${tag} ...${rest}>${make()}<//>`;
}

// Why the content may be out of date, or that it is a replay; empty: it is current.
export function troubleText(live, words) {
  if (live.silentSince === null || !live.data["page.runs"]) {
    return (live.data["page.runs"] || {}).replay || "";
  }
  return words.no_signal.replace("{time}", clockText(live.silentSince, words));
}

// -- texts --------------------------------------------------------------------------------------------

// A line that shrinks until it fits.
export function Fit({children, ...rest}) {
  const element = useRef(null);
  useLayoutEffect(() => {
    const inner = element.current;
    const range = document.createRange();
    range.selectNodeContents(inner);
    Object.assign(inner.style, {fontSize: "", textOverflow: "clip"});  // the dots would count
    const share = inner.getBoundingClientRect().width / range.getBoundingClientRect().width;
    // Whole pixels are not exact enough, and letters do not shrink exactly.
    Object.assign(inner.style, {fontSize: share < 1 ? `${Math.max(SMALLEST, 0.99 * share)}em` : "", textOverflow: ""});
  });
  return html`<span ...${rest}><span class="fit" ref=${element}>${children}</span></span>`;
}

export function Card({run, live}) {
  const {logos} = live.data["page.words"];
  const [team] = run.teams.length === 1 && logos.includes(run.teams[0]) ? run.teams : [];
  return html`
    <article class="card ${run.phase} ${run.is_paused ? "paused" : ""} ${team ? "with-logo" : ""}" data-zone=${run.zone}>
      ${team && html`<img class="logo" src="/logos/${encodeURIComponent(team)}" alt="" />`}
      <${Fit} class="team">${run.team}<//>
      <${Fit} class="benchmark">${run.benchmark}<//>
      <${Fit} class="place">${run.place}<//>
      <${Ticking} class="big" make=${() => bigText(run, live.now())} />
      <span class="word">${run.word}</span>
    </article>`;
}

export function Line({line, scores = line.scores, isMore = false}) {
  return html`
    <li class="line">
      ${!isMore && html`
        <div class="row">
          <span class="time">${line.time}</span>
          <${Fit} class="team">${line.team}<//>
          <${Fit} class="benchmark">${line.benchmark}<//>
          <span class="last">${line.last}</span>
        </div>`}
      ${scores.length > 0 && html`<div class="scores">${scores.join(" · ")}</div>`}
    </li>`;
}

// A run explained: what happens now, its steps, what it is about, and what the robot says.
function explanation(run) {
  const marks = {done: "✓", now: "▶", later: "○"};
  const now = run.steps.some((step) => step.state === "now" && step.text === run.now) ? "" : run.now;
  return [
    (now || run.progress) && html`
      <li class="line now">${now && html`<b>${now}</b> `}${run.progress && html`<span class="progress">${run.progress}</span>`}</li>`,
    run.steps.length > 0 && html`
      <li class="line stepped"><ol class="steps">${run.steps.map((step) => html`
        <li class=${step.state} aria-current=${step.state === "now" ? "step" : undefined}>${marks[step.state]} ${step.text}</li>`)}
      </ol></li>`,
    run.about && html`<li class="line about">${run.about}</li>`,
    ...run.said.slice().reverse().map((text) => html`<li class="line said">${text}</li>`),
  ].filter(Boolean);
}

// The runs explained, each as a list of its own.
function explanations(live) {
  const {runs} = live.data["page.runs"];
  const explained = live.data[EXPLAINED] ? live.data[EXPLAINED].runs : [];
  return explained.filter(isChosen).flatMap((run) => {
    const card = runs.find((one) => one.zone === run.zone);
    return card ? [{title: `${card.team} · ${card.benchmark}`, lines: [], blocks: explanation(run)}] : [];
  });
}

// All lists in the order in which they take turns: title, lines or blocks, and whether only the first page is shown.
export function lists(live, words, show = "rotating") {
  const results = live.data["page.results"], standings = live.data["page.standings"];
  const following = live.data["page.next"].lines.filter(isChosen);
  const next = {title: words.next, lines: following, isFirst: show !== "schedule", nothing: words.schedule_is_done};
  const explained = explanations(live);
  const ranked = (standings ? standings.standings : []).map(({title, lines}) => ({title, lines}));
  const ended = [[words.results, "results"], [words.provisional, "provisional"]]
    .map(([title, name]) => ({title, lines: results ? results[name].filter(isChosen) : []}))
    .filter(({lines}) => lines.length > 0);
  const nothing = (title, text) => [{title, lines: [], nothing: text}];
  return {
    run: explained.length > 0 ? explained : [next],
    schedule: [next],
    standings: ranked.length > 0 ? ranked : nothing(words.standings, words.no_standings),
    results: ended.length > 0 ? ended : nothing(words.results, words.no_results),
  }[show] || [...explained, next, ...ranked, ...ended];
}
