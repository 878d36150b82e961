// Two curators, one list of tours: what each of them did is kept, tour by tour. No page is needed for it.

// base: the list that mine began from. theirs: the list as somebody else has saved it meanwhile. Returns the tours of both,
// in their order and then mine, and in `clashes` the ids of those that both changed, each in another way: of these it has
// mine. A tour that one removed and the other did not change is removed.
export function mergeTours(base, mine, theirs) {
  const find = (list, id) => list.find(one => one.id === id), text = (list, id) => JSON.stringify(find(list, id));
  const tours = [], clashes = [];
  for (const id of new Set([...theirs, ...mine].map(one => one.id))) {
    const was = text(base, id), my = text(mine, id), their = text(theirs, id), isTheirs = my === was && their !== was;
    if (my !== was && their !== was && my !== their) clashes.push(id);
    const one = find(isTheirs ? theirs : mine, id);
    if (one) tours.push(one);
  }
  chooseOne(tours, clashes, mine.find(one => one.attract));
  return { tours, clashes };
}

// At most one tour is flown while nobody is there. If each chose another one it is mine, and theirs clashes.
function chooseOne(tours, clashes, my) {
  const flown = tours.filter(one => one.attract);
  if (!my || flown.length < 2) return;
  for (const one of flown.filter(one => one.id !== my.id)) {
    delete one.attract;
    if (!clashes.includes(one.id)) clashes.push(one.id);
  }
}

// Gives mine up for theirs, of the tours that clash.
export function takeTheirs(mine, theirs, clashes) {
  const isOne = one => clashes.includes(one.id);
  if (theirs.some(one => isOne(one) && one.attract)) for (const one of mine) delete one.attract;
  return mergeTours([...mine.filter(isOne), ...theirs.filter(one => !isOne(one))], mine, theirs).tours;
}
