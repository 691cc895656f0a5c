// The public display. ?zone=… (several), ?show=run, standings, …, ?layout=board or list, ?language=…, ?name=…

import {
  Card, EXPLAINED, Line, Ticking, clockText, html, isChosen, lists, parameters, show, shown, troubleText, useEffect,
  useLayoutEffect, useRef, useState,
} from "/assets/parts.js";

const PAGE_MS = 8000;
// A longer title of the competition has two lines of smaller letters.
const LONG_TITLE = 28;
const CARDS_ON_A_PAGE = 6;
const CARDS_IN_A_COLUMN = 3;
const DOCUMENTS = ["page.words", "page.runs", "page.next", "page.results", "page.standings", EXPLAINED];
// Displays that show something else have no space for runs.
const WITH_RUNS = ["rotating", "run"];
// Scores of one line of a list that stay on one page.
const SCORES_TOGETHER = 4;
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

// Distribute items evenly over pages of limited size; without items there is one empty page.
function evenPages(items, onAPage) {
  const count = Math.max(1, Math.ceil(items.length / onAPage));
  const pages = [];
  for (let number = 0, begin = 0; number < count; number += 1) {
    const end = begin + Math.floor(items.length / count) + (number < items.length % count ? 1 : 0);
    pages.push(items.slice(begin, end));
    begin = end;
  }
  return pages;
}

function Head({live, words, mark}) {
  const trouble = troubleText(live, words);
  if (trouble) {
    return html`
      <header class="alarm">
        <h1 class="unseen">${words.title || words.display}</h1>
        <span role="alert">${trouble}</span>
      </header>`;
  }
  return html`
    <header class="head">
      ${words.logos.includes(LOGO) && html`<img class="logo" src="/logos/${LOGO}" alt="" />`}
      <div class="titles">
        ${words.title && html`<h1 class=${words.title.length > LONG_TITLE ? "title long" : "title"}>${words.title}</h1>`}
        ${!words.title && html`<h1 class="unseen">${words.display}</h1>`}
        <div class="date">${words.date}</div>
      </div>
      <div class="mark">${mark}</div>
      <${Ticking} class="clock" make=${() => clockText(live.now(), words)} />
    </header>`;
}

function mark(title, number, count) {
  return count > 1 ? `${title} ${number + 1}/${count}` : "";
}

function kindOf(list) {
  return list.blocks ? "explained" : "table";
}

// Lines with their scores, in pieces that stay together.
function blocks(list) {
  if (list.blocks) {
    return list.blocks;
  }
  return list.lines.flatMap((line) => {
    const pieces = [line.scores.slice(0, SCORES_TOGETHER)];
    for (let begin = SCORES_TOGETHER; begin < line.scores.length; begin += SCORES_TOGETHER) {
      pieces.push(line.scores.slice(begin, begin + SCORES_TOGETHER));
    }
    return pieces.map((scores, number) => html`<${Line} line=${line} scores=${scores} isMore=${number > 0} />`);
  });
}

// The pages of all lists: how many blocks fit on each is measured on an unseen copy.
function Board({all, turn}) {
  const copy = useRef(null);
  const [sizes, setSizes] = useState("");
  useLayoutEffect(() => {
    const high = copy.current.clientHeight;
    const measured = [...copy.current.children].map((list) => {
      const pages = [0];
      let used = 0;
      for (const block of list.children) {
        const needed = block.getBoundingClientRect().height;
        if (used + needed > high + 1 && pages[pages.length - 1] > 0) {
          pages.push(0);
          used = 0;
        }
        pages[pages.length - 1] += 1;
        used += needed;
      }
      return pages;
    });
    setSizes(JSON.stringify(measured));
  });
  const made = all.map(blocks);
  const pages = (sizes ? JSON.parse(sizes) : []).slice(0, all.length).flatMap((counts, number) => {
    let begin = 0;
    const parts = counts.map((count) => made[number].slice(begin, begin += count));
    const shown = all[number].isFirst ? parts.slice(0, 1) : parts;
    return shown.map((part, i) => ({
      title: mark(all[number].title, i, shown.length) || all[number].title, part, nothing: all[number].nothing,
      kind: kindOf(all[number]),
    }));
  });
  const page = pages.length ? pages[turn % pages.length] : {title: "", part: [], nothing: ""};
  return html`
    <section class="below">
      <h2>${page.title}</h2>
      <div class="lines">
        <ul class=${page.kind}>${page.part}</ul>
        ${page.part.length === 0 && html`<p class="nothing">${page.nothing}</p>`}
        <div class="copy" aria-hidden="true" ref=${copy}>${made.map((part, i) => html`<ul class=${kindOf(all[i])}>${part}</ul>`)}</div>
      </div>
    </section>`;
}

function Lists({all}) {
  return all.map((list) => html`
    <section class="below">
      <h2>${list.title}</h2>
      <ul class=${kindOf(list)}>${blocks(list)}</ul>
      ${blocks(list).length === 0 && html`<p class="nothing">${list.nothing}</p>`}
    </section>`);
}

function Display({live, words}) {
  const [turn, setTurn] = useState(0);
  useEffect(() => {
    const timer = setInterval(() => setTurn((before) => before + 1), PAGE_MS);
    return () => clearInterval(timer);
  }, []);
  document.title = words.title || words.display;
  const kind = layout();
  document.body.dataset.layout = kind;
  if (!live.data["page.runs"]) {
    return html`<p class="waiting">${words.waiting}</p>`;
  }
  const runs = live.data["page.runs"].runs.filter(isChosen);
  const pages = kind === "board" ? evenPages(runs, CARDS_ON_A_PAGE) : [runs];
  const number = turn % pages.length;
  const cards = pages[number];
  const columns = kind === "board" && cards.length > CARDS_IN_A_COLUMN ? 2 : 1;
  const all = lists(live, words, shown());
  const hasRuns = WITH_RUNS.includes(shown());
  return html`
    <${Head} live=${live} words=${words} mark=${hasRuns ? mark(words.runs, number, pages.length) : ""} />
    ${hasRuns && html`
      <section class="cards" data-columns=${columns} data-rows=${Math.ceil(cards.length / columns)}>
        <h2 class="unseen">${words.runs}</h2>
        ${cards.map((run) => html`<${Card} key=${run.zone} run=${run} live=${live} />`)}
        ${cards.length === 0 && html`<p class="nothing">${words.nothing_runs}</p>`}
      </section>`}
    ${kind === "board" ? html`<${Board} all=${all} turn=${turn} />` : html`<${Lists} all=${all} />`}`;
}

show(Display, DOCUMENTS, "display");
