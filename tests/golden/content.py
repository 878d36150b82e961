"""The demo's content in the languages of the golden pictures: content.py CONTENT_FOLDER. The demo has no
Arabic; these pictures need one script that is read from the right."""
import json
import shutil
import sys

folder = sys.argv[1]
arabic = json.load(open("tests/golden/ar.json"))
parts = json.load(open(f"{folder}/parts.json"))
for part in parts["parts"]:
    words = arabic[part["id"]]
    part["title"]["ar"], part["caption"]["ar"] = words["title"], words["caption"]
json.dump(parts, open(f"{folder}/parts.json", "w"), ensure_ascii=False, indent="\t")
tours = json.load(open(f"{folder}/tours.json"))
for tour in tours["tours"]:
    words = arabic[tour["id"]]
    tour["title"]["ar"], tour["caption"]["ar"] = words["title"], words["caption"]
    for stop, caption in zip([stop for stop in tour["stops"] if "caption" in stop], words["stops"]):
        stop["caption"]["ar"] = caption
json.dump(tours, open(f"{folder}/tours.json", "w"), ensure_ascii=False, indent="\t")
scenes = json.load(open(f"{folder}/scenes.json"))
for layer in scenes["layers"]:
    layer["title"]["ar"] = arabic[layer["id"]]
json.dump(scenes, open(f"{folder}/scenes.json", "w"), ensure_ascii=False, indent="\t")
shutil.copy("tests/golden/central-tower.ar.html", f"{folder}/pages/")
ini = open(f"{folder}/temple.ini").read()
ini = "".join("languages = en km ja ar\n" if line.startswith("languages") else line for line in ini.splitlines(True))
open(f"{folder}/temple.ini", "w").write(ini)
