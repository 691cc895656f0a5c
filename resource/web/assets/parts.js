// Parts that several pages share.

import {html, render, useEffect, useLayoutEffect, useRef, useState} from "/assets/vendor/preact-htm.js";
import {Live} from "/assets/live.js";

export {html, useEffect, useLayoutEffect, useRef, useState};

export const parameters = new URLSearchParams(location.search);
// A long text shrinks to at most this share of its size. Then it is shortened: it must stay legible.
const SMALLEST = 0.7;
const DOCUMENTS = ["page.words", "page.runs", "page.next", "page.results", "page.standings"];

// Show a page: `Page` gets the live data and the texts of the language.
export function show(Page, documents = DOCUMENTS) {
  const place = document.getElementById("page");
  const language = parameters.get("language") || navigator.languages.join(",");
  const draw = () => render(html`<${Whole} page=${Page} live=${live} />`, place);
  const live = new Live("events", {documents: documents.join(","), language}, draw);
  window.addEventListener("resize", draw);
  window.live = live;  // for the browser's console, and for tests
  draw();
}

function Whole({page, live}) {
  const words = live.data["page.words"];
  if (!words) {
    return null;
  }
  document.documentElement.lang = words.language;
  document.body.classList.toggle("old", live.silentSince !== null);
  return html`<${page} live=${live} words=${words} />`;
}

// The zones that the address chooses, as in ?zone=Home+A&zone=Home+B; all without one.
export function isChosen(line) {
  const zones = parameters.getAll("zone");
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

// Why the content may be out of date; empty: it is current.
export function troubleText(live, words) {
  if (live.silentSince === null || !live.data["page.runs"]) {
    return "";
  }
  return words.no_signal.replace("{time}", clockText(live.silentSince, words));
}

// -- texts --------------------------------------------------------------------------------------------

// A line that shrinks until it fits.
export function Fit({children, ...rest}) {
  const element = useRef(null);
  useLayoutEffect(() => {
    const inner = element.current;
    inner.style.fontSize = "";
    if (inner.scrollWidth > inner.clientWidth) {
      inner.style.fontSize = `${Math.max(SMALLEST, inner.clientWidth / inner.scrollWidth)}em`;
    }
  });
  return html`<span ...${rest}><span class="fit" ref=${element}>${children}</span></span>`;
}

export function Card({run, live}) {
  return html`
    <article class="card ${run.phase} ${run.is_paused ? "paused" : ""}" data-zone=${run.zone}>
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

// All lists in the order in which they take turns: title, lines, and whether only the first page is shown.
export function lists(live, words) {
  const results = live.data["page.results"], standings = live.data["page.standings"];
  const following = live.data["page.next"].lines.filter(isChosen);
  const found = [{title: words.next, lines: following, isFirst: true, nothing: words.schedule_is_done}];
  for (const standing of standings ? standings.standings : []) {
    found.push({title: standing.title, lines: standing.lines});
  }
  for (const [title, name] of [[words.results, "results"], [words.provisional, "provisional"]]) {
    const lines = results ? results[name].filter(isChosen) : [];
    if (lines.length > 0) {
      found.push({title, lines});
    }
  }
  return found;
}
