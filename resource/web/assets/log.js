// The log of the zone's run and the online data of its robot: the box sends the ends, and the page keeps what came before.

import {html, useEffect, useRef, useState} from "/assets/parts.js";

const MAX_LINES = 2000;
// A shorter overlap could be a coincidence (client/tail.py).
const MIN_OVERLAP = 80;
const LEVEL = /^\S+ (WARNING|ERROR): /;

// What came before the end that was just sent; null: they do not continue each other.
function before(old, end) {
  if (end.startsWith(old)) {
    return "";
  }
  const first = end.slice(0, MIN_OVERLAP);
  for (let at = old.indexOf(first); at >= 0; at = old.indexOf(first, at + 1)) {
    if (end.startsWith(old.slice(at))) {
      return old.slice(0, at);
    }
  }
  return null;
}

// The texts of this zone and event, as long as they were received.
const kept = {of: "", log: "", online: ""};
function keep(data) {
  for (const name of ["log", "online"]) {
    const old = kept.of === data.of ? kept[name] : "", head = data[name] && old ? before(old, data[name]) : "";
    kept[name] = (head === null ? `${old}…\n` : head) + data[name];
  }
  kept.of = data.of;
}

export function Log({data, texts}) {
  const [name, setName] = useState("log");
  const [sought, setSought] = useState("");
  const [at, setAt] = useState(0);
  const view = useRef(null), follows = useRef(true);
  keep(data);
  const lines = kept[name].split("\n").filter(Boolean).slice(-MAX_LINES);
  const matches = sought ? lines.flatMap((line, number) => line.toLowerCase().includes(sought.toLowerCase()) ? [number] : []) : [];
  const current = matches.length > 0 ? matches[((at % matches.length) + matches.length) % matches.length] : -1;
  useEffect(() => {
    if (current >= 0) {
      view.current.children[current].scrollIntoView({block: "nearest"});
    } else if (follows.current) {
      view.current.scrollTop = view.current.scrollHeight;
    }
  }, [current, lines.length, lines[lines.length - 1]]);
  const onScroll = ({target}) => (follows.current = target.scrollHeight - target.scrollTop - target.clientHeight < 8);
  return html`
    <div class="filters">
      <label>${texts.shown_text}<select value=${name} onChange=${(event) => setName(event.target.value)}>
        <option value="log">${texts.part_log}</option><option value="online">${texts.online}</option></select></label>
      <label>${texts.search}<input type="search" value=${sought} onInput=${(event) => (setSought(event.target.value), setAt(-1))}
        onKeyDown=${(event) => event.key === "Enter" && setAt(at + (event.shiftKey ? -1 : 1))} /></label>
    </div>
    ${sought && html`
      <div class="controls"><button type="button" class="button" data-meaning="before" onClick=${() => setAt(at - 1)}>▲</button>
        <p role="status">${texts.matches.replace("{number}", () => matches.length)}</p>
        <button type="button" class="button" data-meaning="after" onClick=${() => setAt(at + 1)}>▼</button></div>`}
    ${lines.length === 0 && html`<p class="nothing">${name === "log" ? texts.no_log : texts.no_online}</p>`}
    <ol class="log" tabindex="0" aria-label=${texts[name === "log" ? "part_log" : "online"]} ref=${view} onScroll=${onScroll}>${lines.map((line, number) => html`
      <li class="${LEVEL.test(line) ? "warned" : ""} ${matches.includes(number) ? "found" : ""} ${number === current ? "now" : ""}">${line}</li>`)}</ol>`;
}
