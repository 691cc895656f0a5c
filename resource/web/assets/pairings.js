// The organiser's list of paired devices, and codes for further ones (docs/web.md, "Pairing").

import {countdown, html, parameters, useEffect, useState} from "/assets/parts.js";
import {ask, reasonsText} from "/assets/device.js";
import {Twice} from "/assets/buttons.js";

const AGAIN_MS = 2000, TICK_MS = 500;

// A QR code: always dark on light, as readers need it.
function Square({rows, label}) {
  const path = rows.flatMap((row, y) => [...row].flatMap((sign, x) => sign === "1" ? [`M${x} ${y}h1v1h-1z`] : [])).join("");
  return html`<svg class="square" role="img" aria-label=${label} viewBox="0 0 ${rows.length} ${rows.length}" shape-rendering="crispEdges">
    <rect width=${rows.length} height=${rows.length} fill="#ffffff" /><path d=${path} fill="#000000" /></svg>`;
}

function Code({made, texts}) {
  const [left, setLeft] = useState(made.valid);
  useEffect(() => {
    const tick = setInterval(() => setLeft(made.valid - (performance.now() - made.at) / 1000), TICK_MS);
    return () => clearInterval(tick);
  }, [made]);
  if (left <= 0) {
    return html`<p class="alarm" role="status">${texts.code_old}</p>`;
  }
  const page = made.url.split("#")[0];
  return html`
    <div class="code">
      ${made.square && html`<${Square} rows=${made.square} label=${made.url} />`}
      <div><p><code>${made.code}</code></p>
        <p>${(made.square ? texts.scan_code : texts.type_code).replace("{page}", () => page)}</p>
        <p>${texts.valid_for.replace("{time}", () => countdown(left))}</p>
        <p class="facts">${made.encryption}</p></div>
    </div>`;
}

export function Pairings({zone, zones, texts}) {
  const [devices, setDevices] = useState([]);
  const [made, setMade] = useState(null);
  const [trouble, setTrouble] = useState("");
  const [role, setRole] = useState("referee");
  const [place, setPlace] = useState("");
  const language = parameters.get("language") || document.documentElement.lang;
  const names = (zones || []).map((one) => one.zone), chosen = place || (zone && zone.zone) || names[0] || "";
  const load = async () => {
    const answer = await ask("GET", `pairings?${new URLSearchParams({language})}`);
    setTrouble((before) => answer.status === 0 ? texts.no_answer : before === texts.no_answer ? "" : before);
    answer.status === 200 && setDevices(answer.body.devices);
  };
  useEffect(() => {
    load();
    const timer = setInterval(load, AGAIN_MS);
    return () => clearInterval(timer);
  }, []);
  const post = async (body) => {
    const answer = await ask("POST", "pairings", {...body, language});
    setTrouble(answer.status === 200 ? "" : reasonsText(answer, texts));
    return answer.status === 200 ? answer.body : null;
  };
  const make = async () => {
    const answer = await post({role, zone: role === "organiser" ? "" : chosen});
    setMade(answer && {...answer, at: performance.now()});
  };
  const end = async (device) => {
    await post({end: device});
    load();
  };
  const select = (label, value, choices, set) => html`
    <label>${label}<select value=${value} onChange=${(event) => (set(event.target.value), setMade(null))}>
      ${choices.map(([name, text]) => html`<option key=${name} value=${name}>${text}</option>`)}</select></label>`;
  return html`
    ${trouble && html`<p class="alarm" role="alert">${trouble}</p>`}
    <div class="filters">
      ${select(texts.may_act_as, role, Object.keys(texts.may).map((one) => [one, texts[`role_${one}`]]), setRole)}
      ${role !== "organiser" && select(texts.zone, chosen, names.map((name) => [name, name]), setPlace)}
    </div>
    <div class="controls"><button type="button" class="button next" data-command="new_code" onClick=${make}>${texts.new_code}</button></div>
    ${made && html`<${Code} key=${made.code} made=${made} texts=${texts} />`}
    <h2>${texts.paired_devices}</h2>
    <ul class="unsigned">${devices.map((one) => html`
      <li key=${one.id} data-device=${one.id}><p><strong>${one.person}</strong> · ${one.role} · ${one.device} · ${one.seen}</p>
        ${one.is_own ? html`<p class="facts">${texts.this_device}</p>` : html`<${Twice} name="end_pairing" label=${texts.end_one}
          question=${texts.really} act=${() => end(one.id)} />`}</li>`)}</ul>`;
}
