// All texts of the page, in each language. A key that one language lacks stops the build.
const WORDS = {
  en: {
    title: 'Thimble: see what a delay does to a force', language: 'Language',
    try_title: 'Push a needle into tissue, over a network',
    delay: 'Force delay, one way', felt: 'Where the force goes', wall: 'Show the virtual wall', sound: 'Sound',
    virtual: 'Let a virtual subject do it', again: 'Start again',
    onset: 'The mark: from {0} ms on it shakes in theory, without friction.',
    HF: 'force in the hand', CF: 'force on the fingertip', CCF: 'on the other hand', VF: 'as a bar',
    hint_start: 'Press and drag down: push the needle in.', hint_key: ' Or use the arrow keys.',
    hint_in: 'Push on, until you meet the virtual wall.', hint_hold: 'Hold still against the wall for 5 seconds.',
    hint_shake: 'It shakes! The force comes late and pushes at the wrong moment. Try the fingertip, or less delay.',
    hint_out: 'Beep: draw the needle out.', hint_watch: 'A virtual subject pushes. Watch the needle at the wall.',
    beep: 'beep',
    depth: 'beyond the wall', force: 'force at the needle', lost: 'contacts lost', frequency: 'shakes per second',
    energy: 'energy into the handle', energy_bad: 'the loop gives out energy',
    plot_needle: 'needle', plot_wall: 'virtual wall', plot_time: 'the last 6 seconds',
    plot: 'Needle (orange) and virtual wall (dashed) over the last six seconds', grip: 'needle depth in millimetres',
    beside_title: 'The same hand, two ways to feel', beside_text: 'Both needles follow one hand, over the network that you have chosen. The left hand feels the force itself, the right one feels it on the fingertip.',
    beside_hand: 'force in the hand', beside_finger: 'force on the fingertip', beside_start: 'Push both with one hand',
    network_title: 'Other networks, and controllers against delay', network_text: 'Networks have jitter and loss as well as delay. Controllers make the force in the hand safe again, and each has its price.',
    network: 'Network', own: 'only the delay above', compensator: 'Controller', none: 'none',
    study_title: 'The experiment, by virtual subjects', study_text: 'Ten virtual subjects do 24 trials each, at 50 ms. Your browser computes all of it.',
    study_start: 'Run experiment 3', study_state: '{0} of {1} trials, {2} times faster than real time', study_shakes: 'The needle shakes in {0} of {1} trials with the force in the hand, and in {2} of {3} others.',
    bar_mean: 'average penetration, mm', bar_max: 'maximum penetration, mm', bar_time: 'completion time, s',
    bytes_title: 'The same bytes', bytes_text: 'This page is the C++ program itself. For one seed, it writes the same table of trials as the program on your machine, to the last byte.',
    seed: 'Seed', digest_start: 'Compute the digest', digest_wait: 'computing ...',
    replay_title: 'Look at a recorded trial', replay_text: 'Every run with trajectories leaves CSV files in its folder trajectories/. Nothing leaves this page.',
    drop: 'Drop a trajectory here, or choose one:', place: 'Time', speed: 'Speed', play: 'Play or stop', replay_error: 'This file is no trajectory of Thimble: the columns {0} are missing.',
    replay_empty: 'This trajectory has no sample.', digest_secure: 'Browsers compute digests for https and file pages only.',
    more_title: 'More', more_text: 'A pointer is no haptic device: it cannot push back, so the needle moves where the hand would. Real handles, fingertip devices and networks need the program:',
    failed: 'This page needs WebAssembly and WebGL 2. ', unit_mm: 'mm', unit_N: 'N', unit_J: 'J', unit_Hz: 'per s',
  },
  it: {
    title: 'Thimble: guarda che cosa fa un ritardo a una forza', language: 'Lingua',
    try_title: 'Spingi un ago nel tessuto, attraverso una rete',
    delay: 'Ritardo in un verso', felt: 'Dove va la forza', wall: 'Mostra il muro virtuale', sound: 'Suono',
    virtual: 'Lascia fare a un soggetto virtuale', again: 'Ricomincia',
    onset: 'Il segno: da {0} ms in su trema in teoria, senza attrito.',
    HF: 'forza nella mano', CF: 'forza sul polpastrello', CCF: "sull'altra mano", VF: 'come una barra',
    hint_start: "Premi e trascina in giù: spingi dentro l'ago.", hint_key: ' Oppure usa i tasti freccia.',
    hint_in: 'Continua a spingere, fino al muro virtuale.', hint_hold: 'Tieni fermo contro il muro per 5 secondi.',
    hint_shake: 'Trema! La forza arriva tardi e spinge nel momento sbagliato. Prova il polpastrello, o meno ritardo.',
    hint_out: "Bip: estrai l'ago.", hint_watch: "Un soggetto virtuale spinge. Guarda l'ago al muro.",
    beep: 'bip',
    depth: 'oltre il muro', force: "forza sull'ago", lost: 'contatti persi', frequency: 'oscillazioni al secondo',
    energy: 'energia nel manipolo', energy_bad: 'il ciclo produce energia',
    plot_needle: 'ago', plot_wall: 'muro virtuale', plot_time: 'gli ultimi 6 secondi',
    plot: 'Ago (arancione) e muro virtuale (tratteggiato) negli ultimi sei secondi', grip: "profondità dell'ago in millimetri",
    beside_title: 'La stessa mano, due modi di sentire', beside_text: 'Entrambi gli aghi seguono una sola mano, sulla rete che hai scelto. A sinistra la mano sente la forza stessa, a destra la sente sul polpastrello.',
    beside_hand: 'forza nella mano', beside_finger: 'forza sul polpastrello', beside_start: 'Spingi entrambi con una mano',
    network_title: 'Altre reti, e controllori contro il ritardo', network_text: 'Le reti hanno variazioni e perdite, oltre al ritardo. I controllori rendono di nuovo sicura la forza nella mano, e ognuno ha il suo prezzo.',
    network: 'Rete', own: 'solo il ritardo qui sopra', compensator: 'Controllore', none: 'nessuno',
    study_title: "L'esperimento, con soggetti virtuali", study_text: 'Dieci soggetti virtuali fanno 24 prove ciascuno, a 50 ms. Il tuo browser calcola tutto.',
    study_start: "Esegui l'esperimento 3", study_state: '{0} di {1} prove, {2} volte più veloce del tempo reale', study_shakes: "L'ago trema in {0} di {1} prove con la forza nella mano, e in {2} di {3} altre.",
    bar_mean: 'penetrazione media, mm', bar_max: 'penetrazione massima, mm', bar_time: 'tempo di completamento, s',
    bytes_title: 'Gli stessi byte', bytes_text: "Questa pagina è il programma C++ stesso. Per un seme scrive la stessa tabella di prove del programma sul tuo computer, fino all'ultimo byte.",
    seed: 'Seme', digest_start: "Calcola l'impronta", digest_wait: 'calcolo ...',
    replay_title: 'Guarda una prova registrata', replay_text: 'Ogni esecuzione con traiettorie lascia file CSV nella cartella trajectories/. Niente esce da questa pagina.',
    drop: 'Trascina qui una traiettoria, o scegline una:', place: 'Tempo', speed: 'Velocità', play: 'Avvia o ferma', replay_error: 'Questo file non è una traiettoria di Thimble: mancano le colonne {0}.',
    replay_empty: 'Questa traiettoria non ha campioni.', digest_secure: "I browser calcolano l'impronta solo per pagine https e file.",
    more_title: 'Altro', more_text: "Un puntatore non è un'interfaccia aptica: non può respingere, quindi l'ago si muove dove si muoverebbe la mano. Manipoli, dispositivi per le dita e reti veri richiedono il programma:",
    failed: 'Questa pagina richiede WebAssembly e WebGL 2. ', unit_mm: 'mm', unit_N: 'N', unit_J: 'J', unit_Hz: 'al s',
  },
};
let language = navigator.language && navigator.language.startsWith('it') ? 'it' : 'en';
function say(key, ...values) {
  return WORDS[language][key].replace(/\{(\d)\}/g, (_, i) => values[i]);
}
// Texts that the C++ has in English: # stands for a number.
const FROM_CPP = {
  it: {
    'virtual wall': 'muro virtuale', 'your hand': 'la tua mano', 'moving hand': 'la mano che muove', '# mm deep': 'a # mm',
    'force in the hand': 'forza nella mano', 'force on the fingertip': 'forza sul polpastrello',
    'force on the other hand': "forza sull'altra mano", 'force as a bar': 'forza come una barra', '# N, like # g': '# N, come # g', '# N, like # kg': '# N, come # kg',
    'No delay': 'Nessun ritardo', 'Internet of the future, # ms': 'Internet del futuro, # ms', 'Cable in the lab': 'Cavo in laboratorio',
    'Wi-Fi, # ms': 'Wi-Fi, # ms', 'Mobile, #G': 'Cellulare, #G', 'Space station overhead, # ms': 'Stazione spaziale sopra di noi, # ms',
    'Low satellite': 'Satellite basso', 'Mobile, # ms': 'Cellulare, # ms', 'Across the Atlantic, # ms': "Attraverso l'Atlantico, # ms",
    'Study, # ms': 'Studio, # ms', 'Slow mobile, # ms': 'Cellulare lento, # ms', 'Satellite, # ms': 'Satellite, # ms',
    'Space station by satellites, # ms': 'Stazione spaziale via satelliti, # ms', 'The Moon, # s': 'La Luna, # s',
  },
};
function translate(text) {
  const numbers = text.match(/\d+(\.\d+)?/g) ?? [];
  const known = FROM_CPP[language]?.[text.replace(/\d+(\.\d+)?/g, '#')];
  return known ? known.replace(/#/g, () => numbers.shift()) : text;
}
function sayAll() {
  document.documentElement.lang = language;
  document.title = say('title');
  for (const place of document.querySelectorAll('[data-words]')) place.textContent = say(place.dataset.words);
  for (const place of document.querySelectorAll('[data-plain]')) place.textContent = translate(place.dataset.plain);
}
