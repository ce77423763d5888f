"""web_rtc.py first | second: one side of two pages that talk over WebRTC, in chromium without a window.

The first side serves the page and passes the offer and the answer on; it ends with the fastest round trip over the data channel
in ms, and the kinds of the two addresses. The second side finds the first at THIMBLE_HOST."""
import http.server
import json
import os
import subprocess
import sys
import tempfile
import threading

PORT = 8700
PATIENCE_S = 60
PAGE = """<!doctype html><script>
const role = location.search.slice(1)
const put = (name, value) => fetch('/' + name, {method: 'POST', body: JSON.stringify(value)})
const get = async (name) => (await fetch('/' + name + '.json')).json()
const connection = new RTCPeerConnection()
const gathered = new Promise((done) => { connection.onicegatheringstatechange = () => connection.iceGatheringState === 'complete' && done() })
async function pair() {
  const stats = [...(await connection.getStats()).values()]
  const chosen = stats.find((s) => s.type === 'candidate-pair' && s.nominated)
  return [chosen.localCandidateId, chosen.remoteCandidateId].map((id) => stats.find((s) => s.id === id).candidateType)
}
async function offer() {
  const channel = connection.createDataChannel('haptics', {ordered: false, maxRetransmits: 0}), times = []
  channel.onmessage = (message) => times.push(performance.now() - message.data)
  channel.onopen = async () => {
    while (times.length < 10) { channel.send(performance.now()); await new Promise((done) => setTimeout(done, 20)) }
    put('result', {least_ms: Math.min(...times), candidates: await pair()})
  }
  await connection.setLocalDescription(); await gathered; await put('offer', connection.localDescription)
  await connection.setRemoteDescription(await get('answer'))
}
async function answer() {
  connection.ondatachannel = (event) => { event.channel.onmessage = (message) => event.channel.send(message.data) }
  await connection.setRemoteDescription(await get('offer'))
  await connection.setLocalDescription(); await gathered; await put('answer', connection.localDescription)
}
(role === 'offer' ? offer : answer)()
</script>"""


class Mailbox(http.server.BaseHTTPRequestHandler):
    letters, arrived = {}, threading.Condition()

    def log_message(self, *words):
        pass

    def say(self, kind, text):
        self.send_response(200)
        self.send_header('Content-Type', kind)
        self.end_headers()
        self.wfile.write(text.encode())

    def do_POST(self):
        body = self.rfile.read(int(self.headers['Content-Length'])).decode()
        with self.arrived:
            self.letters[self.path[1:]] = body
            self.arrived.notify_all()
        self.say('text/plain', '')

    def do_GET(self):
        name = self.path[1:].partition('.json')[0]
        if not self.path.endswith('.json'):
            self.say('text/html', PAGE)
        elif self.wait_for(name):
            self.say('application/json', self.letters[name])

    @classmethod
    def wait_for(cls, name):
        with cls.arrived:
            return cls.arrived.wait_for(lambda: name in cls.letters, PATIENCE_S)


def browse(host, role, profile):
    # A page may see its addresses, which chromium else hides behind names.
    words = ['chromium', '--headless=new', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--no-first-run', '--disable-extensions',
             '--disable-background-networking', '--disable-component-update', '--remote-debugging-port=0',
             '--disable-features=WebRtcHideLocalIpsWithMdns', f'--user-data-dir={profile}', f'http://{host}:{PORT}/?{role}']
    return subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def main():
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        if sys.argv[1] == 'second':
            browse(os.environ['THIMBLE_HOST'], 'answer', profile).wait()
            return
        server = http.server.ThreadingHTTPServer(('', PORT), Mailbox)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        browser = browse('127.0.0.1', 'offer', profile)
        if not Mailbox.wait_for('result'):
            sys.exit(f'no result after {PATIENCE_S} s; letters: {list(Mailbox.letters)}')
        print(json.dumps(json.loads(Mailbox.letters['result'])), flush=True)
        browser.kill()
        browser.wait()


main()
