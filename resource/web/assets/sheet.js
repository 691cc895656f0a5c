// The score sheet of a referee's page: large targets, and what the box has not confirmed yet.

import {html, useState} from "/assets/parts.js";
import {Command} from "/assets/buttons.js";
import {expected, nameOf} from "/assets/commands.js";

function number(text) {
  return text === "" ? null : Number(text);
}

// A phone may type a typographic minus. The box refuses an invalid number.
const whole = (text) => text === "" ? NaN : Number(text.replace("−", "-"));

// Which keys a phone shows for the values of an item: its keypad for decimals may have no minus.
export const keypad = ({type, min}) => type !== "uint" && (min === "" || Number(min) < 0) ? "text" : "decimal";

// A mark that the box has refused, until the referee has read why.
export function RefusedMark({mark, marks, texts}) {
  return html`
    <div class="alarm" role="alert">
      <p>${texts.refused.replace("{what}", () => nameOf(mark)).replace("{reasons}", () => mark.reasons.join("; "))}</p>
      <button type="button" data-command="close_refused" onClick=${() => marks.close(mark)}>${texts.close}</button>
    </div>`;
}

// `mark(item, given, shown)`: enters a mark; `waiting`: marks of this item that were not answered yet.
function Item({item, zone, waiting, refused, mark, texts, judge, give}) {
  const [isOpen, setOpen] = useState(false);
  const [note, setNote] = useState("");
  const enter = (given, shown) => {
    mark(item, {note, ...given}, shown);
    setNote("");
  };
  const minimum = number(item.min), maximum = number(item.max);
  const name = item.desc;
  const late = waiting.some((one) => one.isLate), shown = late ? expected(item, waiting) : item.shown;
  return html`
    <li class="item" data-item=${name}>
      <div class="what"><span>${name}</span>
        <span class="sending" role="status">${refused.length > 0 || late ? "⚠" : waiting.length > 0 && "…"}${
          waiting.length > 0 && html`<span class="unseen">${waiting.map((one) =>
            texts.sending.replace("{mark}", () => one.shown)).join("; ")}</span>`}</span>
        <span class="value"><span><strong class="shown">${shown}</strong>${
          late && html` <small>${texts.queued.replace("{number}", () => waiting.length)}</small>`}</span>
          ${zone.points && html`<span class="points">${item.points}</span>`}</span></div>
      <div class="controls">
        ${item.type === "bool" && !judge && [["yes", 1], ["no", 0]].map(([word, value]) => html`
          <button type="button" aria-pressed=${!item.not_attempted && item.value === value}
              aria-label="${name}: ${texts[word]}" onClick=${() => enter({value}, texts[word])}>
            ${texts[word]}
          </button>`)}
        ${["uint", "int"].includes(item.type) && !judge && html`
          <button type="button" aria-label=${texts.subtract.replace("{item}", () => name)}
              disabled=${item.type === "uint" && item.value <= (minimum || 0) && !item.not_attempted && waiting.length === 0}
              onClick=${() => enter({added: "-1"}, "−1")}>−1</button>
          <button type="button" class="main" aria-label=${texts.add.replace("{item}", () => name)}
              disabled=${maximum !== null && item.value >= maximum}
              onClick=${() => enter({added: "1"}, "+1")}>+1</button>`}
        ${item.type === "choice" && !judge && item.choices.map((choice) => html`
          <button type="button" aria-pressed=${!item.not_attempted && item.text === choice}
              onClick=${() => enter({text: choice}, choice)}>${choice}</button>`)}
        ${item.type === "decimal" && !judge && html`<${Entry} item=${item} label=${texts.value.replace("{item}", () => name)} texts=${texts}
          value=${item.text} enter=${(text) => enter({text}, text)} />`}
        ${item.type === "rating" && item.judges.map((one, i) => (!judge || one === judge) && html`
          <${Entry} item=${item} label=${texts.ratings_of.replace("{judge}", () => one)} isLabelShown texts=${texts}
            value=${item.ratings[i]} enter=${(text) => enter({text, judge: one}, `${one}: ${text}`)} />`)}
        ${!judge && html`<button type="button" class="more" aria-expanded=${isOpen} onClick=${() => setOpen(!isOpen)}
            aria-label=${texts.options.replace("{item}", () => name)}>⋯</button>`}
      </div>
      ${item.late.length > 0 && html`
        <div class="late"><p>⚠ ${texts.late}</p>${give && html`
          <${Command} name="in_time" label=${texts.in_time} act=${() => give("in_time", texts, texts.in_time,
            {identity: zone.identity, entry: item.late[item.late.length - 1]})} />`}</div>`}
      ${isOpen && html`
        <div class="options">
          <button type="button" aria-pressed=${item.not_attempted}
              onClick=${() => item.not_attempted ? enter({value: 0}, "0") : enter({not_attempted: true}, texts.not_attempted)}>
            ${texts.not_attempted}
          </button>
          <label>${texts.note}: ${texts.note_how}
            <input maxlength="200" value=${note} onInput=${(event) => setNote(event.target.value)} />
          </label>
          ${["uint", "int"].includes(item.type) && !judge && html`<${Entry} item=${item} texts=${texts} value=${String(item.value)}
            label=${texts.value.replace("{item}", () => name)} enter=${(text) => enter({value: whole(text)}, text)} />`}
        </div>`}
    </li>`;
}

function Entry({item, label, isLabelShown = false, value, enter, texts}) {
  const [typed, setTyped] = useState(null);
  const submit = (event) => {
    event.preventDefault();
    if (typed !== null) {
      enter(typed.trim());
      setTyped(null);
    }
  };
  return html`
    <form class="entry" onSubmit=${submit}>
      <label><span class=${isLabelShown ? "" : "unseen"}>${label}</span>
        <input inputmode=${keypad(item)} autocomplete="off" value=${typed === null ? value : typed}
          onInput=${(event) => setTyped(event.target.value)} />
      </label>
      ${item.unit && html`<span class="unit">${item.unit}</span>`}
      <button class=${typed === null ? "" : "main"} aria-label="${label}: ${texts.set}">${texts.set}</button>
    </form>`;
}

// `judge`: the name of the judge who may only give ratings; empty: a referee.
// `command`: another one than "mark", on the own sheet of `person`.
// `undo(mark)` takes the last mark of this device back; `give`: a command, as the referee's page gives it.
export function Sheet({zone, marks, texts, judge = "", command = "", person = "", undo = null, give = null}) {
  const last = marks.last(zone.identity);
  const items = judge ? zone.items.filter((item) => item.judges.includes(judge)) : zone.items;
  const mark = (item, given, shown) => marks.add({
    zone: zone.zone, identity: zone.identity, group: item.group, desc: item.desc, ...given, shown,
    ...(command ? {command} : {}),
  });
  const isOf = (item) => (one) => one.identity === zone.identity && one.group === item.group && one.desc === item.desc;
  const groups = [...new Set(items.filter((item) => !item.is_incident).map((item) => item.group))];
  const row = (item) => html`
    <${Item} key="${item.group}/${item.desc}" item=${item} zone=${zone} waiting=${marks.waiting.filter(isOf(item))}
      refused=${marks.refused.filter(isOf(item))} mark=${mark} texts=${texts} judge=${judge} give=${judge ? null : give} />`;
  const incidents = items.filter((item) => item.is_incident);
  return html`
    <section class="sheet">
      <h2>${texts.sheet}</h2>
      ${judge && items.length === 0 && html`<p class="nothing">${texts.not_a_judge.replace("{judge}", () => judge)}</p>`}
      ${groups.map((group) => html`
        <h3>${group}</h3>
        <ul>${items.filter((item) => item.group === group).map(row)}</ul>`)}
      ${incidents.length > 0 && html`
        <details class="incidents"><summary>${zone.incidents || incidents[0].group}</summary><ul>${incidents.map(row)}</ul></details>`}
      ${zone.points && html`<p class="points">${zone.points}</p>`}
      <${Steps} steps=${zone.steps} texts=${texts} />
      ${undo && html`<${Command} key=${last ? last.id : ""} name="undo" label=${last ? texts.undo.replace("{mark}", () => last.shown) : texts.nothing_to_undo}
        isBare reasons=${last ? [] : [""]} act=${() => undo(last)} />`}
    </section>`;
}

// How points came about, where a reader could doubt it.
export function Steps({steps, texts}) {
  return steps.length > 0 && html`
    <details class="steps"><summary>${texts.steps}</summary><ul>${steps.map((step) => html`<li key=${step}>${step}</li>`)}</ul></details>`;
}
