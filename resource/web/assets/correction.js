// The score sheet of a run that is over, until it is signed off: changes are corrections (docs/web.md, "Referees").

import {html, useEffect, useState} from "/assets/parts.js";
import {reasonsText} from "/assets/device.js";
import {send} from "/assets/commands.js";
import {Sheet} from "/assets/sheet.js";

// `undo(mark)` takes the last mark of this device back.
export function Correction({zone, run, marks, texts, undo}) {
  const [isOpen, setOpen] = useState(false);
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
  return html`
    <button type="button" data-command="correct" aria-expanded=${isOpen} onClick=${() => setOpen(!isOpen)}>
      ${isOpen ? texts.close : texts.correct}</button>
    ${isOpen && trouble && html`<p class="alarm" role="alert">${trouble}</p>`}
    ${isOpen && sheet && html`
      <div class="correction">
        <${Sheet} zone=${{...sheet, zone: zone.zone, identity: run.identity}} marks=${marks} texts=${texts} undo=${undo} />
      </div>`}`;
}
