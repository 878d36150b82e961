#!/usr/bin/env python3
"""Signs metadata of The Update Framework as an attacker or another publisher would; for the end-to-end tests.

    tuf_sign.py KEYS RELEASE COMMAND...

    set FILE MEMBER=JSON...    changes members of a signed file's content (with dots: meta.targets.json would not do, so
                               parts are separated by /), signs it with the keys of its type and puts it back
    rename FILE FILE           the same content under another name
    chain                      makes timestamp and snapshot name the files that are there
    delegate ROLE              the targets become those of a role whose key is KEYS/ROLE.key
    adopt ROLE=FILE...         the next root, in which the only key of ROLE is the public key of a file in PEM
    root MEMBER=JSON...        the next root, signed by root.key, into KEYS/tuf and RELEASE/tuf

FILE is below RELEASE/tuf. Keys are files of KEYS: root.key, release.key, timestamp.key.
"""
import ctypes, ctypes.util, hashlib, json, pathlib, sys

sodium = ctypes.CDLL(ctypes.util.find_library("sodium"))
keys, tuf = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]) / "tuf"
KEY_OF = {"root": "root", "timestamp": "timestamp", "snapshot": "release", "targets": "release"}


def canonical(value):
    # canonical JSON has line ends, which a key in PEM has, as they are
    return written(value).replace(rb"\n", b"\n")


def written(value):
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False).encode()


class Key:
    def __init__(self, path):
        seed = bytes.fromhex(path.read_text().split()[-1])
        public, self.secret = ctypes.create_string_buffer(32), ctypes.create_string_buffer(64)
        sodium.crypto_sign_seed_keypair(public, self.secret, seed)
        self.entry = {"keytype": "ed25519", "scheme": "ed25519", "keyval": {"public": public.raw.hex()}}
        self.id = hashlib.sha256(canonical(self.entry)).hexdigest()

    def sign(self, message):
        out = ctypes.create_string_buffer(64)
        sodium.crypto_sign_detached(out, None, message, ctypes.c_ulonglong(len(message)), self.secret)
        return {"keyid": self.id, "sig": out.raw.hex()}


def signed(content, *names):
    message = canonical(content)
    return written({"signed": content, "signatures": [Key(keys / f"{name}.key").sign(message) for name in names]})


def change(content, changes):
    for one in changes:
        path, _, value = one.partition("=")
        *where, last = path.split("/")
        inner = content
        for part in where:
            inner = inner[part]
        inner[last] = json.loads(value)


def content_of(path):
    return json.loads(path.read_bytes())["signed"]


def put(path, data):
    part = path.with_suffix(".part")
    part.write_bytes(data)
    part.rename(path)


def describe(path, version):
    data = path.read_bytes()
    return {"version": version, "length": len(data), "hashes": {"sha256": hashlib.sha256(data).hexdigest()}}


def set_members(name, *changes):
    content = content_of(tuf / name)
    change(content, changes)
    put(tuf / name, signed(content, KEY_OF[content["_type"]]))


def rename(old, new):
    put(tuf / new, (tuf / old).read_bytes())


# The newest targets and the snapshot that names it, whatever their names say.
def newest(kind):
    return max(tuf.glob(f"*.{kind}.json"), key=lambda path: int(path.name.split(".")[0]))


def chain():
    targets, snapshot, timestamp = newest("targets"), newest("snapshot"), tuf / "timestamp.json"
    content = content_of(snapshot)
    content["meta"]["targets.json"] = describe(targets, content_of(targets)["version"])
    put(snapshot, signed(content, "release"))
    stamp = content_of(timestamp)
    stamp["meta"]["snapshot.json"] = describe(snapshot, content["version"])
    stamp["version"] += 1
    put(timestamp, signed(stamp, "timestamp"))


def delegate(role):
    targets, snapshot = content_of(newest("targets")), content_of(newest("snapshot"))
    key, version = Key(keys / f"{role}.key"), targets["version"] + 1
    put(tuf / f"1.{role}.json", signed({**targets, "version": 1}, role))
    targets |= {
        "version": version,
        "targets": {},
        "delegations": {
            "keys": {key.id: key.entry},
            "roles": [
                {"name": role, "keyids": [key.id], "threshold": 1, "paths": ["release.json"], "terminating": True}
            ],
        },
    }
    put(tuf / f"{version}.targets.json", signed(targets, "release"))
    snapshot |= {"version": version}
    snapshot["meta"][f"{role}.json"] = describe(tuf / f"1.{role}.json", 1)
    put(tuf / f"{version}.snapshot.json", signed(snapshot, "release"))
    chain()


# Signed by root.key; into KEYS/tuf alone, from where `publish` copies it.
def adopt(*pairs):
    last = max((keys / "tuf").glob("*.root.json"), key=lambda path: int(path.name.split(".")[0]))
    content = content_of(last)
    content["version"] += 1
    for pair in pairs:
        role, path = pair.split("=")
        text = pathlib.Path(path).read_text()
        is_rsa = len(text) > 300
        entry = {
            "keytype": "rsa" if is_rsa else "ecdsa",
            "scheme": "rsassa-pss-sha256" if is_rsa else "ecdsa-sha2-nistp256",
            "keyval": {"public": text},
        }
        name = hashlib.sha256(canonical(entry)).hexdigest()
        content["keys"][name] = entry
        content["roles"][role] = {"keyids": [name], "threshold": 1}
    used = {one for role in content["roles"].values() for one in role["keyids"]}
    content["keys"] = {one: entry for one, entry in content["keys"].items() if one in used}
    put(keys / "tuf" / f"{content['version']}.root.json", signed(content, "root"))


def root(*changes):
    last = newest("root")
    content = content_of(last)
    change(content, changes)
    for name in ("root", "release", "timestamp"):
        key = Key(keys / f"{name}.key")
        content["keys"][key.id] = key.entry
        for role, of in KEY_OF.items():
            if of == name and f"roles/{role}" not in " ".join(changes):
                content["roles"][role] = {"keyids": [key.id], "threshold": 1}
    content["version"] += 1
    used = {one for role in content["roles"].values() for one in role["keyids"]}
    content["keys"] = {one: entry for one, entry in content["keys"].items() if one in used}
    for folder in (keys / "tuf", tuf):
        put(folder / f"{content['version']}.root.json", signed(content, "root"))


command, *arguments = sys.argv[3:]
commands = {"set": set_members, "rename": rename, "chain": chain, "delegate": delegate, "root": root}
commands |= {"adopt": adopt}
commands[command](*arguments)
