// Buttons of the pages for paired devices.

import {html, useEffect, useState} from "/assets/parts.js";

const CONFIRM_MS = 4000;

// A button with the reasons why it is off as text: a finger cannot hover. `isBare`: they are shown elsewhere. `small`: a
// second line. `isMain`: the next action. `isStacked`: its icon is above.
export function Command({label, small = "", reasons = [], act, isMain = false, isBare = false, isStacked = false, name, children}) {
  const isOff = reasons.length > 0, why = isOff && !isBare ? reasons.join("; ") : "";
  return html`
    <div class="command">
      <button type="button" class="button ${isMain ? "next" : ""}" data-command=${name} data-meaning=${label} disabled=${isOff} onClick=${act}>
        ${isStacked ? html`<span class="stack">${children}<span>${label}</span></span>` : html`${children}<span>${label}${isMain && (why || small) && html`<small>${why || small}</small>`}</span>`}
      </button>
      ${why && !isMain && html`<p class="why">${why}</p>`}
    </div>`;
}

// A command that is pressed twice.
export function Twice({question, act, label, ...rest}) {
  const [isArmed, setArmed] = useState(false);
  useEffect(() => {
    const timer = isArmed && setTimeout(() => setArmed(false), CONFIRM_MS);
    return () => clearTimeout(timer);
  }, [isArmed]);
  const press = () => {
    setArmed(!isArmed);
    if (isArmed) {
      act();
    }
  };
  return html`<${Command} label=${isArmed ? question.replace("{command}", () => label) : label} act=${press} ...${rest} />`;
}

// A command with what it does, or why it is off, in a list. What the reader must know before they press it: its `warning`.
export function CommandRow({isTwice, warning = "", reasons = [], explanation, ...command}) {
  return html`
    <li><span>${explanation}${warning && html`<small class="alarm">⚠ ${warning}</small>`}${
        reasons.length > 0 && html`<small>${reasons.join("; ")}</small>`}</span>
      <${isTwice ? Twice : Command} ...${command} reasons=${reasons} isBare /></li>`;
}
