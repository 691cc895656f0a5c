// A run that is over: its score sheet with history and ends, its sign-off, its way to the final result (docs/web.md).

import {html, useEffect, useState} from "/assets/parts.js";
import {Captain, Facts, itemLines} from "/assets/captain.js";
import {reasonsText} from "/assets/device.js";
import {send} from "/assets/commands.js";
import {Command, Twice} from "/assets/buttons.js";
import {HeadReferee, Objecting, Publication, Reasoned, replayAt} from "/assets/judging.js";
import {Sheet, Steps} from "/assets/sheet.js";

// `run`: as in the zone's list of those that wait for a sign-off, or with more from the list of all runs. Whoever pressed
// its sign-off once, and sees another score then, presses twice again. `isInDock`: the sign-off is there.
export function FinishedRun({zone, run, marks, texts, undo, give, events = [], isInDock = false}) {
  const judged = zone.judging.find((one) => one.identity === run.identity);
  const isOpen = run.is_closed === false, isJudged = run.is_judged || Boolean(judged && judged.count > 0);
  return html`
    <li key=${run.identity} data-listed=${run.identity}>
      <p><strong>${run.title}</strong></p>
      <p>${[run.end, run.score, run.sheet].filter(Boolean).join(" · ")}</p>
      <${WholeSheet} zone=${zone} run=${run} marks=${marks} texts=${texts} undo=${undo} give=${give}
        isFixed=${run.is_signed} hasItems=${!run.is_signed && !isJudged} />
      ${!isOpen && html`<${WholeSheet} zone=${zone} run=${run} texts=${texts} give=${give} isFixed isForCaptain />`}
      ${run.number > 0 && html`<${Proposals} zone=${zone} run=${run} texts=${texts} give=${give} />`}
      ${isJudged && run.sheet && judged && html`<${HeadReferee} zone=${zone.zone} run=${judged} texts=${texts} give=${give} />`}
      ${!run.is_signed && !isInDock && html`
        <${Twice} key=${run.revision} name="sign_off" label=${texts.sign_off} question=${texts.really}
          reasons=${isOpen ? [texts.still_connected] : marks.waiting.some((mark) => mark.identity === run.identity) ? [texts.marks_wait] : []}
          act=${() => give("sign_off", texts, texts.sign_off, {identity: run.identity})} />`}
      ${judged && !isJudged && html`<${Publication} zone=${zone.zone} run=${judged} texts=${texts} give=${give} isSigned=${run.is_signed} />`}
      ${run.put_right && run.put_right.length > 0 && html`<${PutRight} run=${run} events=${events} texts=${texts} give=${give} />`}
    </li>`;
}

// A run that should not count, or not for this team. `events`: the id and the name of each to which it may be moved.
function PutRight({run, events, texts, give}) {
  const [event, setEvent] = useState("");
  const [opened, setOpened] = useState("");
  const form = (name) => {
    const act = async (reason) => {
      const given = name === "move" ? {event, reason} : {reason};
      const isDone = await give(name, texts, texts[`${name}_run`], {identity: run.identity, given});
      setOpened(isDone ? "" : name);
      return isDone;
    };
    return html`
      <${Reasoned} key=${name} name=${name} label=${texts[`${name}_run`]} texts=${texts} act=${act} isOff=${name === "move" && !event}
        more=${name === "move" && html`<label>${texts.move_to}<select value=${event} onChange=${(change) => setEvent(change.target.value)}>
          <option value=""></option>${events.map(([id, text]) => html`<option value=${id}>${text}</option>`)}</select></label>`} />`;
  };
  return html`
    <details class="put-right"><summary>${texts.put_right}</summary>
      <div class="controls">
        <a class="button" target="_blank" href=${replayAt(run.identity)}>${texts.replay}</a>
        ${run.put_right.map((name) => html`
          <button type="button" class="button" key=${name} data-command=${name} aria-expanded=${name === opened}
            onClick=${() => setOpened(name === opened ? "" : name)}>${name === "object" ? texts.object : texts[`${name}_run`]} …</button>`)}
      </div>
      ${opened === "object" ? html`<${Objecting} run=${run} texts=${texts} give=${give} />` : opened && form(opened)}
    </details>`;
}

// The score sheet of a run, fetched while it is open, again after each change; and why it cannot be shown.
function useSheet(zone, run, texts, isOpen) {
  const [sheet, setSheet] = useState(null);
  const [trouble, setTrouble] = useState("");
  useEffect(() => {
    let isCurrent = isOpen;
    if (isOpen) {
      send("sheet", {zone: zone.zone, identity: run.identity}).then((answer) => {
        if (isCurrent) {
          setTrouble(answer.status === 200 ? "" : reasonsText(answer, texts));
          setSheet(answer.status === 200 ? answer.body : sheet);
        }
      });
    }
    return () => {
      isCurrent = false;
    };
  }, [isOpen, run.revision]);
  return [sheet, trouble];
}

// Marks that arrived after the sign-off: one touch accepts or drops each.
export function Proposals({zone, run, texts, give}) {
  const [sheet, trouble] = useSheet(zone, run, texts, true);
  const found = (sheet ? sheet.timeline : []).filter((one) => one.kind === "proposal" && one.state === "proposed");
  const decide = (one, label, accept) => give("decide", texts, label, {identity: run.identity, number: one.number, accept});
  return html`
    <section class="proposals block" data-run=${run.identity}>
      <p><strong>${run.title}</strong></p>
      <p class="banner warning">${trouble || texts.proposals}</p>
      <ul>${found.map((one) => html`
        <li key=${one.id}><p><b>${one.text} ${one.change}</b> ${one.note}
            <small>${[one.clock || one.time, one.who, one.role, one.arrived].filter(Boolean).join(" · ")}</small></p>
          <div class="controls">
            <${Command} name="accept" label=${texts.accept} act=${() => decide(one, texts.accept, true)} />
            <${Command} name="drop" label=${texts.drop} act=${() => decide(one, texts.drop, false)} /></div></li>`)}</ul>
    </section>`;
}

// `hasItems`: they can be corrected here. `isForCaptain`: who reads it, and signs.
function WholeSheet({zone, run, marks, texts, undo, give, isFixed, hasItems, isForCaptain = false}) {
  const [isOpen, setOpen] = useState(false);
  const [sheet, trouble] = useSheet(zone, run, texts, isOpen);
  const enter = (name, label, more) => give(name, texts, label, {identity: run.identity, ...more});
  return html`
    <button type="button" class="button" data-command=${isForCaptain ? "captain_reads" : "correct"} aria-expanded=${isOpen} onClick=${() => setOpen(!isOpen)}>
      ${isOpen ? texts.close : isForCaptain ? `${texts.captain} …` : hasItems ? texts.correct : texts.sheet}</button>
    ${isOpen && trouble && html`<p class="alarm" role="alert">${trouble}</p>`}
    ${isOpen && sheet && html`
      <div class="correction">
        <p class="facts">${sheet.facts.join(" · ")}</p>
        ${sheet.corrections.map((item) => html`
          <p key=${item.id} class=${item.state}>${[item.time, item.who, item.text, item.note, item.said].filter(Boolean).join(" · ")}</p>`)}
        ${hasItems ? html`
          <${Sheet} zone=${{...sheet, zone: zone.zone, identity: run.identity}} marks=${marks} texts=${texts} undo=${undo}
            give=${give} />` : html`
          <${Facts} lines=${itemLines(sheet.items)} />
          <p class="points">${sheet.points}</p><${Steps} steps=${sheet.steps} texts=${texts} />`}
        <${Facts} lines=${sheet.module} />
        ${isForCaptain ? html`<${Captain} signs=${sheet.captain} texts=${texts} act=${(given) => enter("captain", texts.captain, given)} />` : html`
        <details class="history"><summary>${texts.history}: ${sheet.history.length}</summary>
          <ul>${sheet.history.map((entry) => html`
            <li key=${entry.number} class=${entry.is_withdrawn ? "withdrawn" : ""} data-entry=${entry.number}><p>${entry.number}. ${entry.text}</p>
              ${!isFixed && !entry.is_withdrawn && html`<${Asked} name="withdraw" label=${texts.withdraw} texts=${texts}
                act=${(note) => enter("withdraw", texts.withdraw, {entry: entry.number, note})} />`}</li>`)}</ul>
        </details>
        <details class="ends"><summary>${texts.ends}: ${sheet.ends.length}</summary>
          <ul>${sheet.ends.map((end) => html`
            <li key=${end.number}><p>${end.number}. ${end.text}${end.reason && `: ${end.reason}`}</p>
              ${!isFixed && end.is_stop && html`<${Asked} name="stop_reason" label=${texts.stop_reason} texts=${texts}
                act=${(reason) => enter("stop_reason", texts.stop_reason, {reason, stop: end.number})} />`}</li>`)}</ul>
        </details>`}
      </div>`}`;
}

// A button that opens the field for a reason.
function Asked({name, label, texts, act}) {
  const [isOpen, setOpen] = useState(false);
  const done = async (reason) => {
    const isDone = await act(reason);
    setOpen(!isDone);
    return isDone;
  };
  return isOpen ? html`<${Reasoned} name=${name} label=${label} texts=${texts} act=${done} />`
    : html`<button type="button" class="button" data-command=${name} onClick=${() => setOpen(true)}>${label} …</button>`;
}
