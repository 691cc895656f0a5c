// The codes of all teams, for the organiser, to be printed (docs/web.md, "Pages of teams").

import {Trouble, address, html, parameters, show, useEffect, useState} from "/assets/parts.js";
import {ask, reasonsText} from "/assets/device.js";
import {Twice} from "/assets/buttons.js";

function Codes({live, words}) {
  const texts = live.data["page.device_words"];
  const [list, setList] = useState(null);
  const [trouble, setTrouble] = useState("");
  const [isPaired, setPaired] = useState(true);
  const send = async (method) => {
    const body = method === "POST" ? {language: parameters.get("language") || words.language} : undefined;
    const answer = await ask(method, "codes", body);
    setPaired(![401, 403].includes(answer.status));
    setTrouble(answer.status === 200 ? "" : reasonsText(answer, texts));
    if (answer.status === 200) {
      setList(answer.body);
    }
  };
  useEffect(() => {
    send("GET");
  }, []);
  document.title = texts.codes;
  if (!isPaired) {
    return html`
      <h1>${texts.codes}</h1>
      <p class="quiet">${texts.for_organisers}</p>
      <p><a class="button next" href=${address("/pair")}>${texts.pair_title}</a></p>`;
  }
  return html`
    <${Trouble} text=${trouble} />
    <h1>${texts.codes}</h1>
    ${list && html`
      <p class="quiet">${list.team_pages === "all" ? texts.codes_for_all : texts.codes_how}</p>
      <ul class="panel codes-list">${list.codes.map(({team, code}) => html`
        <li data-team=${team}><b>${team}</b> <code>${code}</code>
          <span class="quiet">${location.origin}/team/${encodeURIComponent(team)}</span></li>`)}
      </ul>
      <div class="buttons">
        <button type="button" class="button next" onClick=${() => print()}>${texts.print}</button>
        <${Twice} label=${texts.new_codes} question=${texts.really} act=${() => send("POST")} name="new_codes" />
      </div>`}`;
}

show(Codes, ["page.words", "page.device_words"]);
