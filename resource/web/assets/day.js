// An organiser changes the schedule of the day: chooses what, sees the effect, and then does it (docs/web.md, "The whole box").

import {Icon, html, useEffect, useState} from "/assets/parts.js";
import {reasonsText} from "/assets/device.js";
import {send} from "/assets/commands.js";

const UNDO = "undo";

// `revision`: something that is another one when the schedule is.
export function DayEdits({texts, revision}) {
  const [page, setPage] = useState(null);
  const [action, setAction] = useState("");
  const [given, setGiven] = useState({});
  const [found, setFound] = useState(null);
  const load = async () => {
    const {status, body} = await send("edits", {});
    status === 200 && setPage(body);
  };
  useEffect(() => {
    load();
  }, [revision, texts]);
  const begin = (name) => {
    setAction(name);
    setGiven({});
    setFound(null);
  };
  const enter = (name, value) => {
    setGiven((before) => ({...before, [name]: value}));
    setFound(null);
  };
  const ask = async (name, values, seen) => {
    const {status, body, ...rest} = await send("edit", {action: name, given: values, seen});
    if (status !== 200) {
      setFound({trouble: [reasonsText({status, body, ...rest}, texts)]});
      return;
    }
    setFound({...body, name, values});
    if (body.done) {
      setAction("");
      setGiven({});
      load();
    }
  };
  if (!page) {
    return html`<p class="nothing">${texts.day_how}</p>`;
  }
  const form = page.forms.find(({name}) => name === action);
  const entered = Object.fromEntries(Object.entries(given).filter(([, value]) => value));
  const isMissing = form && form.fields.some(({name, required}) => required && !entered[name]);
  return html`
    <section class="day">
      <label>${texts.day_what}<select data-field="action" value=${action} onChange=${(event) => begin(event.target.value)}>
        <option value="">${"–"}</option>
        ${page.forms.map(({name, label}) => html`<option key=${name} value=${name}>${label}</option>`)}</select></label>
      ${!form && !found && html`<p class="nothing">${texts.day_how}</p>`}
      ${form && html`
        <p class="facts">${form.explanation}</p>
        <div class="form">${form.fields.map((field) => html`
          <label key=${`${action} ${field.name}`}>${field.label}<${Input} field=${field} choices=${page.choices} value=${given[field.name] || ""} set=${(value) => enter(field.name, value)} /></label>`)}</div>`}
      <${Effect} found=${found} texts=${texts} />
      <div class="controls">
        ${form && html`<button type="button" class="button ${found && found.seen ? "" : "next"}" data-command="look" disabled=${isMissing} onClick=${() => ask(action, entered, "")}>${texts.show_effect}</button>`}
        ${found && found.seen && !found.done && html`<button type="button" class="button next" data-command="do" onClick=${() => ask(found.name, found.values, found.seen)}>${texts.do_it}</button>`}
      </div>
      <h3>${texts.edits}</h3>
      ${page.edits.length === 0 && html`<p class="nothing">${texts.no_edits}</p>`}
      <ul class="rows">${page.edits.map((edit) => html`
        <li key=${edit.number}><span class="count">${edit.number}</span>
          <details><summary>${edit.what}<small>${edit.about}</small></summary>${edit.words.map((line) => html`<small key=${line}>${line}</small>`)}</details>
          ${edit.undone && html`<span class="chip">${texts.undone}</span>`}
          ${edit.can_undo && html`<button type="button" class="button" data-command="undo" aria-label="${page.undo}: ${edit.number}" onClick=${() => begin("") || ask(UNDO, {number: edit.number}, "")}>${page.undo}</button>`}</li>`)}</ul>
    </section>`;
}

function Effect({found, texts}) {
  return found && html`
    <div role="status">
      ${found.effects && html`<p class=${found.done ? "todo" : "facts"}>${found.done ? texts.reload_done : texts.effect}</p>
        <ul class="lines">${found.effects.map((line) => html`<li key=${line}>${line}</li>`)}</ul>
        ${found.warnings.map((line) => html`<p key=${line} class="banner warning"><${Icon} name="warning" /> ${line}</p>`)}`}
      ${(found.trouble || []).map((line) => html`<p key=${line} class="alarm">${line}</p>`)}
    </div>`;
}

function Input({field, choices, value, set}) {
  if (field.kind === "of_schedule") {
    return html`<select data-field=${field.name} value=${value} onChange=${(event) => set(event.target.value)}>
      <option value="">${"–"}</option>
      ${choices[field.of].map(([name, text]) => html`<option key=${name} value=${name}>${text}</option>`)}</select>`;
  }
  return html`<input data-field=${field.name} maxlength=${field.characters || 200} value=${value} onInput=${(event) => set(event.target.value)} />`;
}
