// Keys for a laptop, as the panels have them. They press buttons of the page: so what is off, changed just now or locked
// stays so.

import {html} from "/assets/parts.js";

const AGAIN_MS = 2000;

const isTyping = ({target}) => target.matches("input, select, textarea");

// `say(key)`: shows that this key must be pressed again; empty: it need not any more. The buttons of STOP are outside of
// the page, and never locked.
export function listen(place, say) {
  let asked = "", timer = null;
  // Twice for the same button, which names the zone.
  const twice = (key, button, clicks) => {
    clearTimeout(timer);
    const what = `${key} ${button.textContent}`, isSecond = asked === what;
    asked = isSecond ? "" : what;
    say(isSecond ? "" : key);
    timer = setTimeout(() => say(asked = ""), AGAIN_MS);
    for (let click = 0; isSecond && click < clicks; click += 1) {
      button.click();
    }
  };
  window.addEventListener("keydown", (event) => {
    const digit = /^(?:Digit|Numpad)([1-9])$/.exec(event.code);
    if (event.repeat || event.ctrlKey || event.altKey || event.metaKey) {
      return;
    }
    if (event.key === "Escape") {
      const [key, name, clicks] = event.shiftKey ? ["Shift+Esc", ".stopall", 2] : ["Esc", ".stop", 1];
      const button = document.querySelector(name);
      button.hidden || twice(key, button, clicks);
    } else if (digit && !isTyping(event) && !place.inert) {
      const item = place.querySelectorAll(".sheets > .sheet .item")[digit[1] - 1];
      const button = item && item.querySelector(event.shiftKey ? ".take-back" : ".mark:not(.plain)");
      button && button.click();
    } else if (event.key === "?" && !isTyping(event)) {
      const keys = place.querySelector("details.keys");
      keys && (keys.open = !keys.open, keys.scrollIntoView({block: "nearest"}));
    }
  });
}

export function Keys({texts}) {
  return html`
    <details class="keys"><summary>${texts.keys} (?)</summary>
      <dl class="named">${texts.key_list.map(([key, what]) => html`<div key=${key}><dt>${key}</dt><dd>${what}</dd></div>`)}</dl></details>`;
}
