// Several judges of a run: the own sheet of a judge, and the settlement by the head referee (docs/web.md, "Judges").

import {html, secondsOf, useEffect, useRef, useState} from "/assets/parts.js";
import {Twice} from "/assets/buttons.js";
import {send} from "/assets/commands.js";
import {Sheet, keypad} from "/assets/sheet.js";

const AGAIN_MS = 2000;

// What the box answers about a run, asked again after each change; null: no answer yet. Of revision 0 there is nothing to ask.
function useAnswer(zone, run) {
  const [answer, setAnswer] = useState(null);
  const wanted = useRef("");
  useEffect(() => {
    const key = `${run.identity} ${run.revision}`;
    let timer = null;
    wanted.current = key;
    const fetch = async () => {
      const got = await send("judging", {zone, identity: run.identity});
      if (wanted.current !== key) {
        return;
      }
      if (got.status === 200) {
        setAnswer(got.body);
      } else {
        timer = setTimeout(fetch, AGAIN_MS);
      }
    };
    if (run.revision !== 0) {
      fetch();
    }
    return () => clearTimeout(timer);
  }, [zone, run.identity, run.revision]);
  useEffect(() => () => (wanted.current = ""), []);
  return answer;
}

function Progress({run, texts}) {
  return html`
    <ul class="judges">
      ${run.judges.map((one) => html`<li key=${one.judge}>${one.submitted ? "✔" : "…"} ${one.judge}: ${one.state}</li>`)}
      ${run.missing > 0 && html`<li class="missing">${texts.missing_judges.replace("{missing}", () => run.missing)
        .replace("{count}", () => run.count)}</li>`}
      ${run.waiver && html`<li>${texts.waived.replace("{reason}", () => run.waiver)}</li>`}
    </ul>`;
}

// -- a judge ------------------------------------------------------------------------------------------

// `isOld`: there is no link, and a sheet cannot be submitted.
export function JudgeRun({zone, run, marks, texts, person, give, isOld}) {
  const answer = useAnswer(zone, run);
  const waits = marks.waiting.some((mark) => mark.identity === run.identity);
  return html`
    <section class="judging" data-run=${run.identity}>
      <h2>${texts.own_sheet}</h2>
      <p><strong>${run.title}</strong></p>
      <${Progress} run=${run} texts=${texts} />
      ${answer && answer.again && html`<p class="todo urgent" role="status">${texts.look_again.replace("{reason}", () => answer.again)}</p>`}
      ${answer && !answer.submitted && html`
        <${Sheet} zone=${{zone, identity: run.identity, items: answer.items, points: "", steps: []}} marks=${marks} texts=${texts}
          person=${person} command="judge_mark" />
        <fieldset disabled=${isOld}><${Twice} key=${run.identity} name="submit" label=${texts.submit} question=${texts.really} isMain
          reasons=${waits ? [texts.marks_wait] : []} act=${() => give("submit", texts, texts.submit, {identity: run.identity})} /></fieldset>`}
      ${answer && answer.submitted && html`
        <p class="todo" role="status">✔ ${texts.submitted_how}</p>
        <ul>${answer.items.map((item) => html`<li class="item" data-item=${item.desc}><div class="what">
          <span>${item.desc}</span> <strong class="shown">${item.shown}</strong></div></li>`)}</ul>`}
    </section>`;
}

// -- the head referee ---------------------------------------------------------------------------------

export function Reasoned({label, name, act, texts, more = null, isMain = false, isOff = false}) {
  const [reason, setReason] = useState("");
  const isBusy = useRef(false);
  const submit = async (event) => {
    event.preventDefault();
    if (isBusy.current) {
      return;  // touched twice
    }
    isBusy.current = true;
    const isDone = await act(reason.trim());
    isBusy.current = false;
    if (isDone) {
      setReason("");
    }
  };
  return html`
    <form class="reasoned" data-form=${name} onSubmit=${submit}>
      ${more}
      <label>${texts.reason}<input maxlength="300" required value=${reason} onInput=${(event) => setReason(event.target.value)} /></label>
      <button class="button ${isMain && !isOff ? "next" : ""}" disabled=${isOff}>${label}</button>
    </form>`;
}

// The value that the head referee chooses: that of a judge with one touch, or another one.
function Value({one, value, set, texts}) {
  const {item} = one;
  const [typed, setTyped] = useState("");
  const pressed = (chosen) => JSON.stringify(value) === JSON.stringify(chosen);
  const button = (label, chosen) => html`
    <button type="button" class="button" aria-pressed=${pressed(chosen)} aria-label="${item.desc}: ${label}" onClick=${() => set(chosen)}>${label}</button>`;
  const isTyped = !["bool", "choice"].includes(item.type);
  const isWhole = ["bool", "uint", "int"].includes(item.type);
  const chosenBy = (each) => each.not_attempted ? {not_attempted: true} : isWhole ? {value: each.value} : {text: each.text};
  const type = (text) => {
    setTyped(text);
    const whole = text.replace(/^[−–]/, "-");
    set(isWhole ? (/^-?[0-9]+$/.test(whole) ? {value: Number(whole)} : null) : text === "" ? null : {text});
  };
  const chosen = value === null ? typed : value.not_attempted ? "" : isWhole ? value.value : value.text;
  return html`
    <div class="controls given">
      ${one.given.map((each) => html`
        <button type="button" class="button" aria-pressed=${pressed(chosenBy(each))} onClick=${() => set(chosenBy(each))}>
          <span>${each.judge}</span> <strong>${each.shown}</strong></button>`)}
    </div>
    ${isTyped && html`<label>${texts.value.replace("{item}", () => item.desc)}
      <input class="value" inputmode=${keypad(item)} autocomplete="off" value=${chosen}
        onInput=${(event) => type(event.target.value.trim())} /></label>`}
    <div class="controls">
      ${item.type === "bool" && [["yes", 1], ["no", 0]].map(([word, number]) => button(texts[word], {value: number}))}
      ${item.type === "choice" && item.choices.map((choice) => button(choice, {text: choice}))}
      ${button(texts.not_attempted, {not_attempted: true})}
    </div>`;
}

function Judged({one, settle, texts}) {
  const [value, setValue] = useState(null);
  const [isOpen, setOpen] = useState(false);
  const {item} = one;
  const act = async (reason) => {
    const isDone = value !== null && await settle(item, value, reason);
    if (isDone) {
      setOpen(false);
      setValue(null);
    }
    return isDone;
  };
  return html`
    <li class="item judged ${one.outcome}" data-item=${item.desc}>
      <div class="what"><span>${item.group}: ${item.desc}</span>
        <strong class="shown">${one.outcome === "differs" ? `≠ ${texts.differs}` : item.shown}</strong></div>
      ${one.outcome === "differs" || isOpen || html`<div class="given">${one.given.map((each) => html`<p><span>${each.judge}</span> <strong>${each.shown}</strong></p>`)}</div>`}
      ${one.reason && html`<p class="why">${texts.settled_by.replace("{name}", () => one.who).replace("{reason}", () => one.reason)}</p>`}
      ${one.outcome === "differs" || isOpen ? html`
        <${Reasoned} name="settle" label=${texts.settle} act=${act} texts=${texts} isMain isOff=${value === null}
          more=${html`<${Value} one=${one} value=${value} set=${setValue} texts=${texts} />`} />`
        : html`<button type="button" class="button" onClick=${() => setOpen(true)}
            aria-label="${texts.settle}: ${item.desc}">${texts.settle} …</button>`}
    </li>`;
}

// `isSigned`: what comes now is a protest.
function Objections({run, objections, give, texts, isSigned}) {
  const [seconds, setSeconds] = useState(texts.objection_times[0][0]);
  const ask = (name, label, more) => give(name, texts, label, {identity: run.identity, ...more});
  return html`
    <details>
      <summary>${texts.publication}${run.publication && `: ${run.publication}`}</summary>
      ${isSigned || html`<p>${texts.objection_time}</p>
        <div class="controls objection-time">
          ${texts.objection_times.map(([value, text]) => html`
            <button type="button" class="button" aria-pressed=${value === seconds} onClick=${() => setSeconds(value)}>${text}</button>`)}
        </div>
        <${Twice} name="publish" label=${texts.publish} question=${texts.really}
          reasons=${run.off.publish ? [run.off.publish] : []} act=${() => ask("publish", texts.publish, {seconds})} />`}
      <ul>${objections.map((one) => html`
        <li class="item" key=${one.number}><p><strong>${one.number}. ${one.by}</strong>: ${one.text}</p>
          <a class="button" target="_blank" href=${replayAt(run.identity, one.second)}>${texts.replay} ${one.at}</a>
          ${one.is_answered && html`<p class="why">${one.answer}</p>`}
          <${Reasoned} name="uphold" label=${texts.uphold} texts=${texts}
            act=${(text) => ask("answer", texts.uphold, {number: one.number, upheld: true, text})} />
          <${Reasoned} name="reject" label=${texts.reject} texts=${texts}
            act=${(text) => ask("answer", texts.reject, {number: one.number, upheld: false, text})} />
        </li>`)}</ul>
      ${!run.off.object && html`<${Objecting} run=${run} give=${give} texts=${texts} />`}
    </details>`;
}

// The page that plays a run again, from this second of its clock on.
export const replayAt = (identity, second) => `/replay/${encodeURIComponent(identity)}${second ? `#${second}` : ""}`;

export function Objecting({run, give, texts}) {
  const [by, setBy] = useState("");
  const [at, setAt] = useState("");
  return html`
    <${Reasoned} name="object" label=${texts.object} texts=${texts}
      act=${(text) => give("object", texts, texts.object, {identity: run.identity, by: by.trim(), text, second: secondsOf(at)})}
      more=${html`<label>${texts.objection_by}<input maxlength="100" required value=${by}
          onInput=${(event) => setBy(event.target.value)} /></label>
        <label>${texts.objection_at}<input maxlength="7" inputmode="numeric" pattern="[0-9]+(:[0-9]{2})?" value=${at}
          onInput=${(event) => setAt(event.target.value)} /></label>`} />`;
}

// The way of a result from provisional to final, of a run without judges.
export function Publication({zone, run, give, texts, isSigned = false}) {
  const answer = useAnswer(zone, run);
  return html`<div data-run=${run.identity}>
    <${Objections} run=${run} objections=${answer ? answer.objections : []} give=${give} texts=${texts} isSigned=${isSigned} /></div>`;
}

export function HeadReferee({zone, run, give, texts}) {
  const answer = useAnswer(zone, run);
  const decide = (name, label, more) => give(name, texts, label, {identity: run.identity, ...more});
  return html`
    <section class="judging" data-run=${run.identity}>
      <h2>${texts.judges}</h2>
      <p><strong>${run.title}</strong></p>
      <${Progress} run=${run} texts=${texts} />
      ${run.differences > 0 && html`<p class="todo urgent" role="status">${texts.differences.replace("{number}", () => run.differences)}</p>`}
      ${answer && answer.judged.length > 0 && html`
        <ul>${answer.judged.map((one) => html`
          <${Judged} key="${run.identity}/${one.item.group}/${one.item.desc}" one=${one} texts=${texts}
            settle=${(item, value, reason) => decide("settle", texts.settle, {group: item.group, desc: item.desc, ...value, reason})} />`)}</ul>`}
      <details>
        <summary>${texts.judges_more}</summary>
        ${!run.off.waive && html`<${Reasoned} name="waive" label=${texts.waive} texts=${texts}
          act=${(reason) => decide("waive", texts.waive, {reason})} />`}
        ${run.judges.map((one) => html`
          <div key=${one.judge}><h3>${one.judge}</h3>
            ${one.submitted && html`<${Reasoned} name="hand_back" label=${texts.hand_back} texts=${texts}
              act=${(reason) => decide("hand_back", texts.hand_back, {judge: one.judge, reason})} />`}
            <${Reasoned} name="withdraw" label=${texts.withdraw_sheet} texts=${texts}
              act=${(reason) => decide("withdraw_sheet", texts.withdraw_sheet, {judge: one.judge, reason})} /></div>`)}
      </details>
      ${answer && html`<${Objections} run=${run} objections=${answer.objections} give=${give} texts=${texts} />`}
    </section>`;
}
