// Buttons of the pages for paired devices.

import {html, useEffect, useRef, useState} from "/assets/parts.js";

const HOLD_MS = 600;
const CONFIRM_MS = 4000;

// A button with the reasons why it is off as text: a finger cannot hover.
export function Command({label, reasons = [], act, isMain = false, name}) {
  const isOff = reasons.length > 0;
  return html`
    <div class="command">
      <button type="button" class=${isMain && !isOff ? "main" : ""} data-command=${name} disabled=${isOff} onClick=${act}>
        ${label}
      </button>
      ${isOff && html`<p class="why">${reasons.join("; ")}</p>`}
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

// A button that is held down. With a screen reader it is pressed twice.
export function Hold({label, hint, act, ...rest}) {
  const timer = useRef(null);
  const [isHeld, setHeld] = useState(false);
  const [isArmed, setArmed] = useState(false);
  const down = () => {
    clearTimeout(timer.current);  // the end of the touch before may not have come
    setHeld(true);
    timer.current = setTimeout(() => {
      setHeld(false);
      act();
    }, HOLD_MS);
  };
  const up = () => {
    clearTimeout(timer.current);
    setHeld(false);
  };
  const isKey = (event) => event.key === "Enter" || event.key === " ";
  const click = (event) => {
    if (event.detail === 0) {  // neither a finger nor a mouse
      setArmed(!isArmed);
      if (isArmed) {
        act();
      }
    }
  };
  return html`
    <button type="button" class="hold ${isHeld ? "held" : ""}" ...${rest}
        onPointerDown=${down} onPointerUp=${up} onPointerCancel=${up} onPointerLeave=${up}
        onKeyDown=${(event) => isKey(event) && (event.preventDefault(), event.repeat || down())}
        onKeyUp=${(event) => isKey(event) && (event.preventDefault(), up())}
        onContextMenu=${(event) => event.preventDefault()} onClick=${click} onBlur=${up}>
      <span class="what">${label}</span> <span class="hint">${hint}</span>
    </button>`;
}
