// The captain of a team reads the score sheet of a run, and signs it or refuses (docs/web.md, "The captain").

import {Icon, html, useRef, useState} from "/assets/parts.js";

// The field of a signature, which is kept as lines between whole units of it, and its most characters.
const WIDE = 400, HIGH = 150, MOST = 3900;
const STEP = 4;  // units between two points

// Names and values.
export function Facts({lines}) {
  return lines.length > 0 && html`
    <dl class="named">${lines.map(([name, value]) => html`<div key=${name}><dt>${name}</dt><dd>${value}</dd></div>`)}</dl>`;
}

// What a captain reads: each item with its value.
export const itemLines = (items) => items.map((item) => [`${item.group}: ${item.name}`, item.shown]);

function Signature({drawing, draw, label}) {
  const last = useRef(null);  // the last point, while a finger is down
  const pointOf = ({currentTarget, clientX, clientY}) => {
    const {left, top, width, height} = currentTarget.getBoundingClientRect();
    const unit = (part, most) => Math.round(Math.min(1, Math.max(0, part)) * most);
    return [unit((clientX - left) / width, WIDE), unit((clientY - top) / height, HIGH)];
  };
  const down = (event) => {
    event.currentTarget.setPointerCapture(event.pointerId);
    const point = last.current = pointOf(event);
    draw((before) => `${before}M${point.join(" ")}`.slice(0, before.length > MOST ? before.length : undefined));
  };
  const move = (event) => {
    const point = last.current && pointOf(event);
    if (point && Math.hypot(point[0] - last.current[0], point[1] - last.current[1]) >= STEP) {
      last.current = point;
      draw((before) => before.length > MOST ? before : `${before}L${point.join(" ")}`);
    }
  };
  const up = () => (last.current = null);
  // Else the browser takes a quick line for a swipe, and the next touch for its end.
  const stay = (event) => event.preventDefault();
  return html`
    <svg class="signature" viewBox="0 0 ${WIDE} ${HIGH}" role="img" aria-label=${label} onTouchStart=${stay}
        onPointerDown=${down} onPointerMove=${move} onPointerUp=${up} onPointerCancel=${up}><path d=${drawing} /></svg>`;
}

// `signs`: what the box has, of which the last one holds; `act(given)`: signs or refuses, and returns whether that was done.
export function Captain({signs, act, texts}) {
  const [name, setName] = useState("");
  const [comment, setComment] = useState("");
  const [drawing, setDrawing] = useState("");
  const sign = async (refused) => {
    if (await act({name: name.trim(), comment: comment.trim(), refused, drawing: refused ? "" : drawing})) {
      [setName, setComment, setDrawing].forEach((set) => set(""));
    }
  };
  const typed = (label, value, set, most) => html`<label>${label}
    <input maxlength=${most} value=${value} onInput=${(event) => set(event.target.value)} /></label>`;
  return html`
    <section class="captain" aria-label=${texts.captain}>
      ${signs.map((one) => html`
        <p class="banner ${one.refused || one.outdated ? "warning" : ""}"><${Icon} name=${one.refused || one.outdated ? "warning" : "sign"} />
          <span>${one.text}${one.comment && `: ${one.comment}`}</span></p>
        ${one.drawing && html`<svg class="signature ${one.outdated ? "outdated" : ""}" viewBox="0 0 ${WIDE} ${HIGH}" aria-hidden="true"><path d=${one.drawing} /></svg>`}`)}
      <p class="quiet">${texts.captain_how}</p>
      ${typed(texts.captain_name, name, setName, 100)}
      ${typed(texts.comment, comment, setComment, 300)}
      <${Signature} drawing=${drawing} draw=${setDrawing} label=${texts.captain_how} />
      <div class="controls">
        <button type="button" class="button main" data-command="captain" disabled=${!name.trim()} onClick=${() => sign(false)}><${Icon} name="sign" /> ${texts.sign}</button>
        <button type="button" class="button" data-command="refuse" disabled=${!name.trim() || !comment.trim()} onClick=${() => sign(true)}>${texts.refuse}</button>
        <button type="button" class="button quiet" disabled=${!drawing} onClick=${() => setDrawing("")}>${texts.clear}</button>
      </div>
    </section>`;
}
