// The score sheet of a referee's page as a ledger: what a row gives on the left, its points in one column, and at the right
// edge one button that shows what one touch gives. What the box has not confirmed yet has a dashed edge.

import {Icon, html, useState} from "/assets/parts.js";
import {Command} from "/assets/buttons.js";
import {nameOf} from "/assets/commands.js";

const number = (text) => text === "" ? null : Number(text);

// A phone may type a typographic minus. The box refuses an invalid number.
const whole = (text) => text === "" ? NaN : Number(text.replace("−", "-"));

// Which keys a phone shows for the values of an item: its keypad for decimals may have no minus.
export const keypad = ({type, min}) => type !== "uint" && (min === "" || Number(min) < 0) ? "text" : "decimal";

const MOST_MARKS = 5;
const COUNTS = ["uint", "int"];
const isShare = (item) => item.step !== 1;
const isOf = (item, identity) => (one) => one.identity === identity && one.group === item.group && one.desc === item.desc;

// The number of an item with the marks that are on their way.
export function counted(item, waiting) {
  const now = isShare(item) ? Number(item.text || 0) : item.value;
  return waiting.reduce((sum, {added, value, text, not_attempted}) =>
    added ? sum + Number(added) : not_attempted ? 0 : isShare(item) ? Number(text || 0) : value, now);
}

// A mark that the box has refused, until the referee has read why.
export function RefusedMark({mark, marks, texts}) {
  return html`
    <div class="banner warning" role="alert"><${Icon} name="warning" />
      <p>${texts.refused.replace("{what}", () => nameOf(mark)).replace("{reasons}", () => mark.reasons.join("; "))}</p>
      <button type="button" class="button" data-command="close_refused" onClick=${() => marks.close(mark)}>${texts.close}</button>
    </div>`;
}

// `mark(item, given, shown)`: enters a mark; `waiting`: marks of this item that were not answered yet.
function Item({item, zone, waiting, refused, mark, texts, judge, give, happenings, isFixed}) {
  const [isOpen, setOpen] = useState(false);
  const [note, setNote] = useState("");
  const enter = (given, shown) => {
    mark(item, {note, ...given}, shown);
    setNote("");
  };
  const {name} = item, isBool = item.type === "bool", isCount = COUNTS.includes(item.type);
  const canEnter = !judge && !isFixed, isTouched = canEnter && (isBool || isCount || isShare(item));
  const count = isTouched ? counted(item, waiting) : 0, isWaiting = waiting.length > 0;
  const before = isShare(item) ? Number(item.text || 0) : item.value;
  const minimum = number(item.min), maximum = number(item.max);
  const isMost = isBool ? count > 0 : maximum !== null && count >= maximum;
  const canTakeBack = count > (item.type === "int" ? minimum === null ? -Infinity : minimum : 0) || item.not_attempted;
  const shown = !isTouched || !isWaiting ? item.shown : isBool ? texts[count ? "yes" : "no"] : `${count}${isShare(item) ? " %" : ""}`;
  // Until the box says what they are worth.
  const points = Number(item.points || 0) + (count - before) * Number(item.each || 0) / (isShare(item) ? 100 : 1);
  const hasPoints = zone.points && item.points !== "";
  const value = !hasPoints ? shown : isWaiting && isTouched ? String(Math.round(points * 1000) / 1000).replace("-", "−") : item.points.replace("-", "−");
  const isWorth = item.gives.length > 0 && item.gives !== "+1" || item.choices.length > 0 || Boolean(item.each);
  const isEarned = isWorth && (hasPoints ? points !== 0 : count > 0);
  const touch = (sign) => isBool ? enter({value: Number(sign > 0)}, texts[sign > 0 ? "yes" : "no"])
    : enter({added: String(sign * item.step)}, `${sign > 0 ? "+" : "−"}${item.step}${isShare(item) ? " %" : ""}`);
  const late = waiting.some((one) => one.isLate), hasHelp = item.help || item.decided.length > 0;
  return html`
    <li class="item ${item.is_penalty ? "penalty" : item.under ? "modifier" : ""} ${count > 0 ? "given" : ""}" data-item=${item.desc}>
      <button type="button" class="item-name" aria-expanded=${isOpen} data-meaning=${name} onClick=${() => setOpen(!isOpen)}>${name}
        <small><b class="shown ${hasPoints && (isBool || !isTouched && !item.text) ? "unseen" : ""}">${shown}</b> ${item.worth} ${
          hasHelp && html`<b class="ask">?</b>`}</small></button>
      ${isTouched ? html`<button type="button" class="take-back ${canTakeBack ? "" : "none"}" disabled=${!canTakeBack} data-meaning="less"
          onClick=${() => touch(-1)}><${Icon} name=${item.is_penalty || isBool ? "undo" : "minus"} /><span class="unseen">${
          texts.subtract.replace("{item}", () => name)}</span></button>` : html`<span></span>`}
      <span class="value ${value.length > 4 ? "long" : ""} ${isEarned ? "has" : ""} ${isWaiting ? "pending-mark" : ""}">${value}${(refused.length > 0 || late) && html`<${Icon} name="warning" />`}<span
        class="unseen" role="status">${waiting.map((one) => texts.sending.replace("{mark}", () => one.shown)).join("; ")}</span></span>
      ${isTouched ? html`<button type="button" class="mark ${isWorth ? "" : "neutral"} ${isBool && count ? "on" : ""}" aria-pressed=${isBool ? Boolean(count) : undefined} data-meaning="more"
          disabled=${isMost && !isBool} onClick=${() => isMost || touch(1)}>
          ${isBool && count ? html`<${Icon} name=${item.is_penalty ? "flag" : "check"} /><span class="unseen">${texts.yes}</span>`
            : html`${item.is_penalty && html`<${Icon} name="flag" />`}${item.gives || texts.yes}`}<span class="unseen"> ${name}</span></button>`
        : canEnter && html`<button type="button" class="mark plain" aria-expanded=${isOpen} data-meaning=${name} onClick=${() => setOpen(!isOpen)}><${Icon} name="more" /><span
            class="unseen">${texts.options.replace("{item}", () => name)}</span></button>`}
      ${item.type === "choice" && canEnter && html`
        <div class="controls">${item.choices.map((choice, i) => html`
          <button type="button" class="button ${Number(item.choice_points[i] || 0) > 0 ? "earns" : ""}" aria-pressed=${!item.not_attempted && item.text === choice}
              onClick=${() => enter({text: choice}, choice)}>${choice}</button>`)}</div>`}
      ${item.type === "decimal" && !isShare(item) && canEnter && html`<div class="controls"><${Entry} item=${item} label=${texts.value.replace("{item}", () => name)} texts=${texts}
        value=${item.text} enter=${(text) => enter({text}, text)} /></div>`}
      ${item.type === "rating" && html`<div class="controls">${item.judges.map((one, i) => !isFixed && (!judge || one === judge) && html`
        <${Entry} item=${item} label=${texts.ratings_of.replace("{judge}", () => one)} isLabelShown texts=${texts}
          value=${item.ratings[i]} enter=${(text) => enter({text, judge: one}, `${one}: ${text}`)} />`)}</div>`}
      ${item.void && html`<div class="late banner warning"><${Icon} name="warning" /><p>${item.void}</p></div>`}
      ${item.late.length > 0 && html`
        <div class="late banner warning"><${Icon} name="late" /><p>${texts.late}. ${texts.was_in_time}</p>${give && [["yes", false], ["no", true]].map(([word, isLate]) => html`
          <${Command} name=${isLate ? "too_late" : "in_time"} label=${texts[word]} act=${() => give("in_time", texts, texts.in_time,
            {identity: zone.identity, entry: item.late[item.late.length - 1], late: isLate})} />`)}</div>`}
      ${isOpen && html`
        <div class="options help">
          ${item.help && html`<p><${Icon} name="rules" /> ${item.help}</p>`}
          ${item.decided.map((ruling) => html`<p><${Icon} name="ruling" /> ${ruling}</p>`)}
          ${happenings.filter((one) => one.group === item.group && one.desc === item.desc).slice(0, MOST_MARKS).map((one) => html`
            <p key=${one.id} class="small ${one.state || ""}"><${Icon} name="timeline" /> ${[one.clock || one.time, one.change, one.who, one.said].filter(Boolean).join(" · ")}</p>`)}
          ${canEnter && html`<label>${texts.note}: ${texts.note_how}
            <input maxlength="200" value=${note} onInput=${(event) => setNote(event.target.value)} />
          </label>`}
          ${(isCount || isShare(item)) && canEnter && html`<${Entry} item=${item} texts=${texts} value=${String(count)} label=${texts.value.replace("{item}", () => name)}
            enter=${(text) => enter(isShare(item) ? {text} : {value: whole(text)}, text)} />`}
          ${canEnter && html`<button type="button" class="button" aria-pressed=${item.not_attempted}
              onClick=${() => item.not_attempted ? enter({value: 0}, "0") : enter({not_attempted: true}, texts.not_attempted)}>
            ${texts.not_attempted}</button>`}
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
      <button class="button ${typed === null ? "" : "main"}">${texts.set}<span class="unseen"> ${label}</span></button>
    </form>`;
}

// Groups that differ by a number at the end are repetitions, of which one is shown.
const repeated = (group) => (/^(.*\S)\s+\d+$/.exec(group) || [])[1];

function Groups({groups, zone, row, texts}) {
  const [chosen, setChosen] = useState({});
  const parts = [];
  for (const [name, items] of groups) {
    const of = repeated(name), last = parts[parts.length - 1];
    of && last && last.of === of ? last.some.push([name, items]) : parts.push({of, some: [[name, items]]});
  }
  return parts.map(({of, some}, i) => {
    const [name, items] = some.find(([one]) => one === chosen[of]) || some[0], isMany = some.length > 1;
    return html`
      <div class="sheet-head" key=${some[0][0]}><h2>${isMany ? of : name}</h2>
        ${isMany && html`<div class="repeats">${some.map(([one]) => html`
          <button type="button" key=${one} data-meaning=${one} aria-current=${one === name ? "true" : undefined} onClick=${() => setChosen({...chosen, [of]: one})}>
            <b>${one.slice(of.length)}</b><small>${(zone.groups || {})[one] || "–"}</small></button>`)}</div>`}
        ${zone.points && html`<p class="total">${i === 0 ? html`<b>${zone.total.replace("-", "−")}</b> <span class="quiet small">${texts.points_in_all}</span>` : !isMany && html`<span class="quiet">${zone.groups[name]}</span>`}</p>`}
      </div>
      <ul key="items of ${name}">${items.map(row)}</ul>`;
  });
}

// `judge`: the name of the judge who may only give ratings; empty: a referee.
// `command`: another one than "mark", on the own sheet of `person`.
// `undo(mark)` takes the last mark of this device back; `give`: a command, as the referee's page gives it.
// `isFixed`: nothing can be entered. `happenings`: what happened in the run, the latest first. `onMark(item)`: called before a mark is entered. `only`: incidents are shown alone, or not at all; empty: below the rest.
export function Sheet({zone, marks, texts, judge = "", command = "", person = "", undo = null, give = null, onMark = null, only = "", happenings = [], isFixed = false}) {
  const last = marks.last(zone.identity);
  const items = judge ? zone.items.filter((item) => item.judges.includes(judge)) : zone.items;
  const mark = (item, given, shown) => {
    onMark && onMark(item, given);
    marks.add({
      zone: zone.zone, identity: zone.identity, group: item.group, desc: item.desc, ...given, shown,
      ...(command ? {command} : {}),
    });
  };
  const groups = new Map();
  items.filter((item) => !item.is_incident).forEach((item) => groups.set(item.group, [...(groups.get(item.group) || []), item]));
  const row = (item) => html`
    <${Item} key="${item.group}/${item.desc}" item=${item} zone=${zone} waiting=${marks.waiting.filter(isOf(item, zone.identity))}
      refused=${marks.refused.filter(isOf(item, zone.identity))} mark=${mark} texts=${texts} judge=${judge} give=${judge ? null : give} happenings=${happenings} isFixed=${isFixed} />`;
  const incidents = items.filter((item) => item.is_incident);
  if (only === "incidents") {
    return html`<ul>${incidents.map(row)}</ul>`;
  }
  return html`
    <section class="sheet" aria-label=${texts.sheet}>
      ${judge && items.length === 0 && html`<p class="nothing">${texts.not_a_judge.replace("{judge}", () => judge)}</p>`}
      <${Groups} groups=${[...groups]} zone=${zone} row=${row} texts=${texts} />
      ${!only && incidents.length > 0 && html`
        <details class="incidents-of-run"><summary>${zone.incidents || incidents[0].group}</summary><ul>${incidents.map(row)}</ul></details>`}
      ${zone.points && html`<p class="points quiet">${zone.points}</p>`}
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
