// The public display. ?zone=… (several), ?show=run, standings, …, ?layout=board or list, ?language=…, ?name=…

import {
  Clock, EXPLAINED, Fit, Icon, Line, Progress, Standing, State, TeamMark, Ticking, Trouble, Zone, band, clockText, html,
  initials, isChosen, lists, parameters, ranksOf, show, shown, troubleText, useEffect, useLayoutEffect, useRef, useState,
} from "/assets/parts.js";

const PAGE_MS = 8000;
const ZONES_ON_A_PAGE = 6;
const ZONES_IN_A_COLUMN = 3;
const DOCUMENTS = ["page.words", "page.runs", "page.next", "page.results", "page.standings", EXPLAINED];
// Displays that show something else have no space for runs.
const WITH_RUNS = ["rotating", "run"];
// So many of the next events are shown at once on a phone.
const SOON = 5;
// Scores of one line of a list that stay on one page.
const SCORES_TOGETHER = 4;
// How long a result has the screen to itself.
const RESULT_MS = 10000;
// The competition's, among the pictures of the teams.
const LOGO = "competition";

function layout() {
  const asked = parameters.get("layout");
  if (asked === "board" || asked === "list") {
    return asked;
  }
  // A list can be scrolled, for a phone in a hand; a board turns its pages, for a screen on a wall.
  return innerWidth >= 800 && innerWidth > innerHeight ? "board" : "list";
}

// Distribute items evenly over pages of limited size; without items there is no page.
function evenPages(items, onAPage) {
  const count = Math.ceil(items.length / onAPage);
  return Array.from({length: count}, (_, page) => items.slice(
    Math.ceil(items.length * page / count), Math.ceil(items.length * (page + 1) / count)));
}

const numbered = (title, number, count) => (count > 1 ? `${title} ${number + 1}/${count}` : title);

function Top({live, words, title}) {
  const trouble = troubleText(live, words);
  return html`
    <header class="top">
      ${trouble ? html`<${Trouble} text=${trouble} />` : html`
        ${words.logos.includes(LOGO) && html`<${TeamMark} team=${LOGO} live=${live} />`}
        <span class="title"><span>${title || words.title}</span></span>
        ${!title && html`<span class="date">${words.date}</span>`}
        <${Ticking} class="clock" make=${() => clockText(live.now(), words).slice(0, 5)} />`}
    </header>`;
}

// The next event, and how late it is.
function Next({line, words}) {
  return html`
    <footer class="next-up">
      ${line && html`
        <${Fit} class="what">${words.next}: <b>${line.team}</b> · ${[line.benchmark, line.last].filter(Boolean).join(" · ")}<//>
        ${line.planned ? html`
          <span class="chip warning"><${Icon} name="late" /> ${words.late.replace("{time}", () => line.time).replace("{planned}", () => line.planned)}</span>`
        : html`<b>${line.time}</b>`}`}
    </footer>`;
}

// The runs while something else has the screen: their clocks are always there.
const Runs = ({runs, live}) => html`
  <footer class="runs">${runs.map((run) => html`
    <div key=${run.zone} class=${band(run)}>
      ${runs.length > ZONES_IN_A_COLUMN ? html`<b class="team">${initials(run.team)}</b>` : html`<${Fit} class="team">${run.team}<//>`}
      <${Clock} run=${run} live=${live} /><${Progress} run=${run} live=${live} />
    </div>`)}</footer>`;

function Zones({runs, live, words, next}) {
  const columns = runs.length > ZONES_IN_A_COLUMN ? 2 : 1;
  return html`
    <section class="zones" data-columns=${columns} data-rows=${Math.ceil(runs.length / columns)}>
      <h2 class="unseen">${words.runs}</h2>
      ${runs.map((run) => html`<${Zone} key=${run.zone} run=${run} live=${live} />`)}
      ${runs.length === 0 && html`
        <div class="nothing"><p class="lead">${words.nothing_runs}</p>
          ${next && html`<p>${[`${words.next}: ${next.time}`, next.team, next.benchmark, next.last].filter(Boolean).join(" · ")}</p>`}
        </div>`}
    </section>`;
}

// The moment of a result: on one ground, however the run ended.
const Result = ({line, live, words}) => html`
  <section class="result band completed">
    <${TeamMark} team=${line.of_team} live=${live} />
    <div class="who">
      <${Fit} tag="h2" class="team">${line.team}<//>
      <${Fit} tag="p" class="benchmark">${line.benchmark}<//>
    </div>
    <p class="points">
      ${line.points ? html`<b>${line.points}</b> <span>${words.points}</span>` : html`<${State} run=${line} word=${line.last} />`}
      ${line.rank && html`<b class="rank">${words.rank_is.replace("{rank}", () => line.rank)}</b>`}
    </p>
    ${line.scores.length > 0 && html`
      <ul class="scores">${line.scores.slice(0, SCORES_TOGETHER).map(([name, value]) => html`<li><b>${value}</b> <span>${name}</span></li>`)}</ul>`}
  </section>`;

// A result that came while this page is open, for some seconds.
function useNewResult(live) {
  const {results} = live.data["page.results"];
  const known = useRef(null);
  const [moment, setMoment] = useState(null);
  useEffect(() => {
    const line = known.current && live.silentSince === null
      && results.find((one) => !known.current.has(one.key) && isChosen(one));
    known.current = new Set(results.map(({key}) => key));
    line && setMoment(line);
  }, [results]);
  useEffect(() => {
    const timer = moment && setTimeout(() => setMoment(null), RESULT_MS);
    return () => clearTimeout(timer);
  }, [moment]);
  return moment;
}

// What stays together of a list, in the order in which it is shown.
function blocks(list) {
  if (list.blocks || list.standing) {
    return list.blocks || ranksOf(list.standing);
  }
  return list.lines.flatMap((line) => Array.from({length: Math.max(1, Math.ceil(line.scores.length / SCORES_TOGETHER))}, (_, number) => html`
    <${Line} line=${line} scores=${line.scores.slice(SCORES_TOGETHER * number, SCORES_TOGETHER * (number + 1))} isMore=${number > 0} />`));
}

function List({list, part = blocks(list), live, words}) {
  if (list.standing) {
    return html`<${Standing} standing=${list.standing} ranks=${part} live=${live} words=${words} />`;
  }
  return part.length === 0 ? html`<p class="nothing">${list.nothing}</p>`
    : html`<ul class=${list.blocks ? "explained" : "lines"}>${part}</ul>`;
}

// How many blocks of each list fit on each of its pages: measured on an unseen copy.
function useCounts(all, copy) {
  const [sizes, setSizes] = useState("[]");
  useLayoutEffect(() => {
    const high = copy.current.clientHeight;
    setSizes(JSON.stringify([...copy.current.children].map((list) => {
      const pages = [0], head = list.querySelector("thead");
      const free = high - (head ? head.getBoundingClientRect().height : 0);
      let used = 0;
      for (const block of list.tagName === "TABLE" ? list.tBodies[0].rows : list.matches("ul") ? list.children : []) {
        const needed = block.getBoundingClientRect().height;
        if (used + needed > free + 1 && pages[pages.length - 1] > 0) {
          pages.push(0);
          used = 0;
        }
        pages[pages.length - 1] += 1;
        used += needed;
      }
      return pages;
    })));
  });
  return JSON.parse(sizes).slice(0, all.length);
}

// All screens in turns: the runs, then each page of the lists, with the runs between them.
function Board({live, words, runs, all, hasRuns, turn}) {
  const copy = useRef(null);
  const zones = hasRuns ? evenPages(runs, ZONES_ON_A_PAGE) : [];
  const pages = useCounts(all, copy).flatMap((counts, number) => {
    let begin = 0;
    const made = blocks(all[number]);
    const parts = counts.map((count) => made.slice(begin, begin += count));
    const taken = all[number].isFirst ? parts.slice(0, 1) : parts;
    return taken.map((part, place) => ({list: all[number], part, title: numbered(all[number].title, place, taken.length)}));
  }).filter(({part}) => !hasRuns || part.length > 0);
  const screens = !hasRuns ? pages : zones.length === 0 ? [{runs: []}, ...pages]
    : Array.from({length: Math.max(zones.length, pages.length)}, (_, place) => [
      {runs: zones[place % zones.length], title: zones.length > 1 && numbered(words.runs, place % zones.length, zones.length)},
      ...(pages.length ? [pages[place % pages.length]] : [])]).flat();
  const screen = screens.length ? screens[turn % screens.length] : {list: {nothing: ""}, part: []};
  const [next] = live.data["page.next"].lines.filter(isChosen);
  return html`
    <${Top} live=${live} words=${words} title=${screen.title} />
    ${screen.runs ? html`<${Zones} runs=${screen.runs} live=${live} words=${words} next=${next} />` : html`
      <section class="list" style=${{"--rows": screen.part.length + 1}}>
        <h2 class="unseen">${screen.title}</h2>
        <${List} key=${screen.title} list=${screen.list} part=${screen.part} live=${live} words=${words} />
      </section>`}
    <div class="copy" aria-hidden="true" ref=${copy}>${all.map((list) => html`<${List} list=${list} live=${live} words=${words} />`)}</div>
    ${screen.runs || !hasRuns || runs.length === 0 ? html`<${Next} line=${next} words=${words} />`
    : html`<${Runs} runs=${runs.slice(0, ZONES_ON_A_PAGE)} live=${live} />`}`;
}

function Display({live, words}) {
  const [turn, setTurn] = useState(0);
  useEffect(() => {
    const timer = setInterval(() => setTurn((before) => before + 1), PAGE_MS);
    return () => clearInterval(timer);
  }, []);
  document.title = words.title || words.display;
  const kind = document.body.dataset.layout = layout();
  const moment = useNewResult(live);
  const runs = live.data["page.runs"].runs.filter(isChosen);
  const all = lists(live, words, shown());
  const hasRuns = WITH_RUNS.includes(shown());
  const title = html`<h1 class="unseen">${words.title || words.display}</h1>`;
  if (kind === "list") {
    return html`${title}
      <${Top} live=${live} words=${words} />
      ${moment && html`<${Result} line=${moment} live=${live} words=${words} />`}
      ${hasRuns && html`<${Zones} runs=${runs} live=${live} words=${words} />`}
      ${all.map((list) => html`<section><h2>${list.title}</h2>${list.isFirst && list.lines.length > SOON ? html`
        <${List} list=${list} part=${blocks(list).slice(0, SOON)} />
        <details><summary>${words.all_events.replace("{number}", () => list.lines.length)}</summary><${List} list=${list} part=${blocks(list).slice(SOON)} /></details>`
    : html`<${List} list=${list} live=${live} words=${words} />`}</section>`)}`;
  }
  if (moment) {
    return html`${title}
      <${Top} live=${live} words=${words} title=${words.results} />
      <${Result} line=${moment} live=${live} words=${words} />
      ${runs.length > 0 ? html`<${Runs} runs=${runs.slice(0, ZONES_ON_A_PAGE)} live=${live} />`
    : html`<${Next} line=${live.data["page.next"].lines.filter(isChosen)[0]} words=${words} />`}`;
  }
  return html`${title}<${Board} live=${live} words=${words} runs=${runs} all=${all} hasRuns=${hasRuns} turn=${turn} />`;
}

show(Display, DOCUMENTS, "display");
