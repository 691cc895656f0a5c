// The home devices, and commands to operate them (docs/web.md, "The whole box").

import {html, useEffect, useRef, useState} from "/assets/parts.js";
import {reasonsText} from "/assets/device.js";
import {send} from "/assets/commands.js";

const AGAIN_MS = 1000;
const WAITING = " …";

// A percentage: a slider and the exact number. What is dragged or typed is not overwritten.
function Percentage({one, value, change}) {
  const [entered, setEntered] = useState(null);
  const enter = (event) => setEntered(event.target.value);
  const take = ({target}) => {
    setEntered(null);
    if (target.value !== "") {
      change(Math.min(100, Math.max(0, Math.round(Number(target.value)))));
    }
  };
  const rest = {min: 0, max: 100, value: entered === null ? value : entered, "aria-label": one.name, onInput: enter, onChange: take,
    onBlur: () => setEntered(null)};
  return html`<input type="range" ...${rest} /><input type="number" inputmode="numeric" ...${rest} />`;
}

function Device({one, value, isWaiting, change}) {
  const [first, ...others] = one.commands;
  const button = ([text, set]) => html`
    <button type="button" class="button" data-meaning=${text} data-value=${set} aria-label="${one.name}: ${text}" onClick=${() => change(set, text)}>${text}</button>`;
  return html`
    <li data-device=${one.device}>
      <strong>${one.name}</strong>
      <span class=${value ? "on" : ""}>${one.states[Number(Boolean(value))] || `${value} %`}${isWaiting && WAITING}</span>
      <div class="controls">
        ${button(first)}
        ${one.states.length === 0 && html`<${Percentage} one=${one} value=${value} change=${(set) => change(set, `${set} %`)} />`}
        ${others.map(button)}
      </div>
    </li>`;
}

export function Devices({texts, give}) {
  const [answer, setAnswer] = useState(null);
  const [, redraw] = useState(0);
  const wished = useRef({});  // what the box has not confirmed, by device
  const changes = useRef(0);
  const load = async () => {
    const before = changes.current, found = await send("devices", {});
    before === changes.current && setAnswer(found);  // otherwise it may be older than the change
  };
  useEffect(() => {
    let timer = 0;
    const again = () => load().then(() => timer !== null && (timer = setTimeout(again, AGAIN_MS)));
    again();
    return () => {
      clearTimeout(timer);
      timer = null;
    };
  }, []);
  // One change at a time: STOP must find a connection that is free. Of those of a device that wait, the last one follows.
  const change = (one) => async (value, text) => {
    const isBusy = Object.keys(wished.current).length > 0;
    wished.current[one.device] = {value, text: `${one.name}: ${text}`};
    redraw((before) => before + 1);
    while (!isBusy && Object.keys(wished.current).length > 0) {
      const [[device, wish]] = Object.entries(wished.current);
      await give("set_device", texts, wish.text, {device, value: wish.value});
      changes.current += 1;
      await load();
      if (wished.current[device] === wish) {
        delete wished.current[device];
      }
      redraw((before) => before + 1);
    }
  };
  if (!answer || answer.status !== 200) {
    return answer && html`<p class=${answer.status === 409 ? "nothing" : "alarm"} role="status">${reasonsText(answer, texts)}</p>`;
  }
  const {connection, reason, is_connected, devices, bell} = answer.body;
  return html`
    <p class="todo ${is_connected ? "" : "urgent"}" role="status">${connection}</p>
    <p class="facts lined">${reason}</p>
    <ul class="devices">${[...devices, bell].map((one) => html`
      <${Device} key=${one.device} one=${one} change=${change(one)} isWaiting=${one.device in wished.current}
        value=${(wished.current[one.device] || one).value} />`)}</ul>`;
}
