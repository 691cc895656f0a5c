// Buttons of the pages for paired devices.

import {html, useEffect, useState} from "/assets/parts.js";

const CONFIRM_MS = 4000;

// A button with the reasons why it is off as text: a finger cannot hover. `isBare`: they are shown elsewhere.
export function Command({label, reasons = [], act, isMain = false, isBare = false, name}) {
  const isOff = reasons.length > 0;
  return html`
    <div class="command">
      <button type="button" class=${isMain && !isOff ? "main" : ""} data-command=${name} disabled=${isOff} onClick=${act}>
        ${label}
      </button>
      ${isOff && !isBare && html`<p class="why">${reasons.join("; ")}</p>`}
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

// Commands in cells that never move. Why some are off is in a place of its own, the next command first. Before these is
// what the reader must know before they press a command that is on: its `warning`.
export function Cells({commands}) {
  const whys = new Map();
  for (const {label, reasons} of [...commands].sort((one, other) => other.isMain - one.isMain)) {
    const why = reasons.join("; ");
    if (why) {
      whys.set(why, [...(whys.get(why) || []), label]);
    }
  }
  return html`
    <div class="cells">${commands.map(({isTwice, warning, ...command}) => html`
      <${isTwice ? Twice : Command} key="${command.name} ${command.of || ""}" ...${command} isBare />`)}</div>
    <ul class="whys" tabindex="0">${commands.filter(({warning}) => warning).map(({label, warning}) => html`
      <li class="alarm" key=${label}>⚠ ${label}: ${warning}</li>`)}${[...whys].map(([why, labels]) => html`<li key=${why}>${labels.join(", ")}: ${why}</li>`)}</ul>`;
}
