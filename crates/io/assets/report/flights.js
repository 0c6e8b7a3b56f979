// What is on its way between agents: packets where links carry packets; elsewhere marks on what is heard, by when it was said and when it was first heard.

const flightsOf = (() => {
  const links = new Map(scene.packets.map((link) => [`${link.from} ${link.to}`, link]));
  const middle = (values) => [...values].sort((a, b) => a - b)[values.length >> 1] ?? 0;

  // Each as what was sent when, and how long it took or, if it was lost, the others usually take.
  const ofPackets = ({ sent_s, took_s }) => {
    const usual = middle(took_s.filter((took) => took !== null));
    return sent_s.map((sent, k) => ({ sent, took: took_s[k] ?? usual, lost: took_s[k] === null }));
  };
  // What is heard at a row was said as long ago as it is old. Only what is newer than all before counts, and no more marks than can be told apart.
  const ofAges = (series) => {
    const [times, ages] = [data.t("delays"), data.values("delays", series)];
    const apart = Math.max(0.5 * middle(ages.filter((age) => age !== null)), (times.at(-1) ?? 0) / 400);
    const found = [];
    let newest = -apart;
    times.forEach((time, row) => {
      const sent = time - ages[row];
      if (ages[row] === null || ages[row] < 1e-9 || sent < Math.max(0, newest + apart)) return;
      newest = sent;
      found.push({ sent, took: ages[row], lost: false });
    });
    return found;
  };

  const kept = new Map();
  const known = (key, make) => {
    if (!kept.has(key)) {
      const list = make();
      kept.set(key, { list, longest: list.reduce((most, { took }) => Math.max(most, took), 0) });
    }
    return kept.get(key);
  };
  // How far each is that takes longer than `pace`.
  return ({ from, to, delay }, time, pace) => {
    const link = links.get(`${from} ${to}`);
    if (!link && delay === null) return [];
    const { list, longest } = link ? known(link, () => ofPackets(link)) : known(delay, () => ofAges(delay));
    let [low, high] = [0, list.length];
    while (low < high) {
      const half = (low + high) >> 1;
      if (list[half].sent < time - longest) low = half + 1;
      else high = half;
    }
    const under = [];
    for (let k = low; k < list.length && list[k].sent <= time; k++) {
      const { sent, took, lost } = list[k];
      if (took > pace && time < sent + took) under.push({ share: (time - sent) / took, lost, sent });
    }
    return under;
  };
})();
const flightWords = scene.packets.length ? "Dots are packets on their way; rings fade where one is lost." : "";
