// The organiser's list of displays, and what each of them shows (docs/web.md, "Displays").

import {Trouble, address, clockText, html, parameters, show, useEffect, useState} from "/assets/parts.js";
import {ask, reasonsText} from "/assets/device.js";

const AGAIN_MS = 2000;
const NOT_SET = "\u0000";

function Choice({id, text, value, choices, texts, act}) {
  return html`
    <div>
      <label for=${id}>${text}</label>
      <select id=${id} value=${value === null ? NOT_SET : value} onChange=${(event) => act(event.target.value === NOT_SET ? null : event.target.value)}>
        <option value=${NOT_SET}>${texts.as_address}</option>
        ${choices.map(([each, name]) => html`<option value=${each}>${name}</option>`)}
      </select>
    </div>`;
}

function Typed({id, text, value, act, ...rest}) {
  const [typed, setTyped] = useState(null);  // the list comes again while somebody types
  const changed = async (event) => {
    await act(event.target.value);
    setTyped(null);
  };
  return html`
    <div>
      <label for=${id}>${text}</label>
      <input id=${id} value=${typed === null ? value : typed} autocomplete="off" ...${rest}
        onInput=${(event) => setTyped(event.target.value)} onChange=${changed} />
    </div>`;
}

function facts(row, words, texts) {
  const {display} = row;
  if (!display) {
    return texts.not_connected;
  }
  const {zone, show: what, language} = row.setting;
  const zones = zone === null ? display.zones : [zone].filter(Boolean);
  return [
    `/${display.page}`, display.address, display.size.replace("x", " × "),
    texts[`${display.page === "display" ? "show" : "overlay"}_${what || display.show}`] || "",
    zones.length > 0 ? zones.join(", ") : texts.all_zones, language || display.language,
    texts.since.replace("{time}", () => clockText(display.since, words)),
    ...(row.windows > 1 ? [texts.windows.replace("{number}", () => row.windows)] : []),
  ].filter(Boolean).join(" · ");
}

function Row({row, list, words, texts, set, takeBack}) {
  const {setting} = row;
  const part = (name) => `${name}-${row.id}`;
  const zones = [...new Set([...list.zones, ...(setting.zone ? [setting.zone] : [])])];
  const name = row.name || texts.unnamed;
  const isOverlay = row.display ? row.display.page === "overlay" : Boolean(setting.caption);
  const shows = isOverlay ? list.overlay_shows : list.shows;
  return html`
    <li class="panel ${row.display ? "" : "gone"}" data-name=${row.name}>
      <h2>${name}</h2>
      <p class="quiet">${facts(row, words, texts)}</p>
      <fieldset>
        <legend class="unseen">${name}</legend>
        <${Typed} id=${part("name")} text=${texts.name} value=${setting.name} maxlength="40"
          placeholder=${row.display ? row.display.name : ""} act=${(value) => set({name: value})} />
        <${Choice} id=${part("show")} text=${texts.show} value=${setting.show} texts=${texts} act=${(value) => set({show: value})}
          choices=${shows.map((one) => [one, texts[isOverlay ? `overlay_${one}` : `show_${one}`]])} />
        <${Choice} id=${part("zone")} text=${texts.zone} value=${setting.zone} texts=${texts} act=${(value) => set({zone: value})}
          choices=${[["", texts.all_zones], ...zones.map((zone) => [zone, zone])]} />
        <${Choice} id=${part("language")} text=${texts.language} value=${setting.language} texts=${texts}
          act=${(value) => set({language: value})} choices=${list.languages.map((one) => [one, one])} />
        ${isOverlay && html`
          <${Typed} id=${part("caption")} text=${texts.caption} value=${setting.caption} maxlength="120"
            placeholder=${texts.caption_how} act=${(value) => set({caption: value, show: value ? "caption" : null})} />`}
      </fieldset>
      ${row.is_set && html`<button type="button" class="button" data-command="take_back" onClick=${takeBack}>${texts.take_back}</button>`}
    </li>`;
}

function Displays({live, words}) {
  const texts = live.data["page.device_words"];
  const [list, setList] = useState(null);
  const [trouble, setTrouble] = useState("");
  const [isPaired, setPaired] = useState(true);
  const load = async () => {
    const answer = await ask("GET", "displays");
    setPaired(![401, 403].includes(answer.status));
    if (answer.status === 200) {
      setList(answer.body);
    }
    return answer;
  };
  useEffect(() => {
    let timer;
    const again = async () => {
      const answer = await load();
      setTrouble((before) => (answer.status === 0 ? texts.no_answer : before === texts.no_answer ? "" : before));
      timer = setTimeout(again, AGAIN_MS);
    };
    again();
    return () => clearTimeout(timer);
  }, []);
  document.title = texts.displays;

  async function send(body) {
    const answer = await ask("POST", "displays", {...body, language: parameters.get("language") || words.language});
    await load();
    setTrouble(answer.status === 200 ? "" : reasonsText(answer, texts));
  }

  if (!isPaired) {
    return html`
      <h1>${texts.displays}</h1>
      <p class="quiet">${texts.for_organisers}</p>
      <p class="quiet">${texts.pair_how}</p>
      <p><a class="button next" href=${address("/pair")}>${texts.pair_title}</a></p>`;
  }
  return html`
    <${Trouble} text=${trouble} />
    <h1>${texts.displays}</h1>
    <p class="quiet">${texts.displays_how}</p>
    ${list && html`
      <div class="buttons">
        <button type="button" class="button" data-command="show_names" onClick=${() => send({show_names: true})}>${texts.show_names}</button>
        <a class="button" href=${address("/codes")}>${texts.codes}</a>
      </div>
      <ul class="screens">${list.displays.map((row) => html`
        <${Row} key=${row.id} row=${row} list=${list} words=${words} texts=${texts}
          set=${(change) => send({id: row.id, setting: change})}
          takeBack=${() => send({id: row.id, take_back: true})} />`)}
      </ul>
      ${list.displays.length === 0 && html`<p class="panel empty quiet">${texts.no_displays}</p>`}
      ${list.unlisted > 0 && html`<p class="quiet">${texts.unlisted.replace("{number}", () => list.unlisted)}</p>`}`}`;
}

show(Displays, ["page.words", "page.device_words"]);
