// Starts the page, or what a check asks for: thimble.html#check=SEED.
(async () => {
  const check = /^#check=(\d+)$/.exec(location.hash);
  let done = !check;
  // A browser under --virtual-time-budget lets its clock run while other threads unpack and compile, unless it has tasks.
  (async () => { while (!done) await nextTask(); })();
  try {
    const engine = await Engine.start(PACKED);
    if (check) {
      const seed = +check[1], place = $('check');
      place.textContent = JSON.stringify({ seed, sha256: await engine.digest(seed) });
      place.hidden = false;
      done = true;
      return;
    }
    window.page = new Page(engine);
  } catch (error) {
    done = true;
    $('failed').textContent = say('failed') + error;
    throw error;
  }
})();
