// In each page: a part that was lost on the way, such as a script, would leave it empty or without its looks. The page
// is loaded again as soon as the gateway answers.
addEventListener("error", ({target}) => {
  if (target instanceof Element && target.matches("script, link[rel=stylesheet]")) {
    setTimeout(async function again() {
      const isAnswered = await fetch(location.href, {cache: "no-store"}).then(({ok}) => ok, () => false);
      isAnswered ? location.reload() : setTimeout(again, 2000);
    }, 2000);
  }
}, true);
