// The list of all pages.

import {address, html, show, troubleText} from "/assets/parts.js";

const DATA = ["state", "schedule", "results", "standings", "explained"];

function Links({title, links}) {
  return html`
    <section class="below">
      <h2>${title}</h2>
      <ul class="links">${links.map(([text, to]) => html`<li><a href=${to}>${text}</a></li>`)}</ul>
    </section>`;
}

function Index({live, words}) {
  document.title = words.title || "RoAH RSBB";
  const runs = live.data["page.runs"] ? live.data["page.runs"].runs : [];
  const lines = live.data["page.next"] ? live.data["page.next"].lines : [];
  const done = live.data["page.results"] ? live.data["page.results"].results : [];
  const zones = [...new Set([...runs, ...lines].map((line) => line.zone))].sort();
  const teams = [...new Set([...runs.flatMap((run) => run.teams), ...[...lines, ...done].map((line) => line.of_team)])]
    .filter((team) => team !== "ALL").sort();
  const perZone = (path) => [
    [words.all_zones, address(path)],
    ...(zones.length > 1 ? zones.map((zone) => [zone, address(path, {zone})]) : []),
  ];
  const trouble = live.data["page.runs"] ? troubleText(live, words) : words.waiting;
  return html`
    ${trouble && html`<header class="alarm"><span role="alert">${trouble}</span></header>`}
    <h1 class="title">${words.title || "RoAH RSBB"}</h1>
    <${Links} title=${words.display} links=${perZone("/display")} />
    <${Links} title=${words.overlay} links=${perZone("/overlay")} />
    ${teams.length > 0 && html`
      <${Links} title=${words.teams} links=${teams.map((team) => [team, address(`/team/${encodeURIComponent(team)}`)])} />`}
    <${Links} title=${words.referees} links=${[
      [words.referee_page, address("/referee")], [words.box_page, address("/box")], [words.pair_page, address("/pair")],
      [words.displays_page, address("/displays")], [words.codes_page, address("/codes")]]} />
    <${Links} title=${words.data} links=${DATA.map((name) => [name, `/api/v1/${name}`])} />`;
}

show(Index);
