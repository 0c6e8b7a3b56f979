// What is on its way between agents: packets where links carry packets; elsewhere marks on what is heard, by when it was said and when it was first heard.

const links = new Map(scene.packets.map((link) => [`${link.from} ${link.to}`, link]));

// What a receiver holds of a link, from when on and since when: the newest packet that has arrived, and until the first what everybody knew at t = 0.
const held = (() => {
  const kept = new Map();
  return (from, to) => {
    const key = `${from} ${to}`;
    // Of packets that are not all here nobody can say which is the newest.
    if (!links.has(key) || scene.packets_every > 1) return null;
    if (!kept.has(key)) {
      const { sent_s, took_s } = links.get(key);
      const arrived = sent_s.map((sent, k) => ({ sent, at: took_s[k] === null ? Infinity : sent + took_s[k] })).filter(({ at }) => at < Infinity);
      arrived.sort((a, b) => a.at - b.at);
      const list = [{ at: 0, sent: 0 }];
      for (const one of arrived) if (one.sent >= list.at(-1).sent) list.push(one);
      kept.set(key, list);
    }
    return kept.get(key);
  };
})();
const packetAge = (from, to, time) => {
  const list = held(from, to);
  if (list === null) return null;
  let [low, high] = [0, list.length - 1];
  while (low < high) {
    const half = (low + high + 1) >> 1;
    if (list[half].at <= time) low = half;
    else high = half - 1;
  }
  return time - list[low].sent;
};
// The least and the greatest age of what is heard on links whose packets are all here.
const packetAges = () =>
  scene.packets.flatMap(({ from, to }) => {
    const list = held(from, to) ?? [];
    return list.flatMap(({ at, sent }, k) => [at - sent, (list[k + 1]?.at ?? Math.max(at, index.until_s)) - sent]);
  });

const flightsOf = (() => {
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
    // Between two values there is no place for a mark.
    if (!link && (delay === null || index.delays[delay].band)) return [];
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
const ordinal = (n) => `${n}${["th", "st", "nd", "rd"][n % 100 > 10 && n % 100 < 14 ? 0 : n % 10] ?? "th"}`;
const everyPacket = scene.packets_every > 1 ? `every ${ordinal(scene.packets_every)} packet on its way` : "packets on their way";
const flightWords = scene.packets.length ? `Dots are ${everyPacket}; rings fade where one is lost.` : "";
