"""XML DUMP: compares messages as LLRP Toolkit XML has them with our decoder's dump (JSON); prints what differs.
Names of enumerated values are pyllrp's."""
import calendar
import json
import re
import sys
import time
import xml.etree.ElementTree as ET

from pyllrp import llrpdef

ENUMS = {e["name"]: {name: number for number, name in e["choices"]} for e in llrpdef.enums}
FIELDS = {}
for element in llrpdef.parameters + llrpdef.messages:
    for field in element.get("fields", []):
        FIELDS[element["name"], field["name"]] = field


def local(tag):
    return tag.split("}")[-1]


def microseconds(text):
    whole, fraction = re.fullmatch(r"(.*?)(?:\.(\d+))?Z?", text).groups()
    return calendar.timegm(time.strptime(whole, "%Y-%m-%dT%H:%M:%S")) * 1000000 + int((fraction or "").ljust(6, "0"))


def number(word, field):
    if word in ("true", "false"):
        return int(word == "true")
    if re.fullmatch(r"-?\d+", word):
        return int(word)
    return ENUMS[field.get("enumeration")][word]


def value(parent, name, text, dumped):
    """The text as the dump has it."""
    field = FIELDS.get((parent, name), {})
    text = text or ""
    if isinstance(dumped, str):
        return text
    if "T" in text and text.endswith("Z"):
        return microseconds(text)
    hexadecimal = field.get("format") == "Hex" or field.get("type") in ("bitarray", "bytesToEnd") or name == "Data"
    if isinstance(dumped, list) and hexadecimal:
        digits = text.replace(" ", "").replace("\n", "")
        width = 4 if field.get("type") == "array:16" else 2
        return [int(digits[i:i + width], 16) for i in range(0, len(digits), width)]
    if isinstance(dumped, list):
        return [number(word, field) for word in text.split()]
    return number(text.strip(), field)


def compare(xml, dump, path):
    name, content = dump[0], dump[1]
    here = path + "." + name
    if local(xml.tag) != name:
        return print("differs:", here, "is", local(xml.tag))
    children = list(xml)
    if len(children) != len(content):
        return print("differs:", here, "has", len(children), "children, not", len(content))
    for child, dumped in zip(children, content):
        if len(child) or (dumped[1] == [] and not (child.text or "").strip()) or is_tree(dumped):
            compare(child, dumped, here)
            continue
        if local(child.tag) != dumped[0]:
            print("differs:", here, local(child.tag), dumped)
        elif value(name, dumped[0], child.text, dumped[1]) != dumped[1]:
            print("differs:", here, dumped, "XML:", child.text)


def is_tree(dumped):
    return isinstance(dumped[1], list) and len(dumped[1]) > 0 and isinstance(dumped[1][0], list)


messages = list(ET.parse(sys.argv[1]).getroot())
dumps = json.load(open(sys.argv[2]))
if len(messages) != len(dumps):
    print("differs:", len(messages), "messages in XML, decoded", len(dumps))
compared = 0
for index, (message, dump) in enumerate(zip(messages, dumps)):
    if dump is None:
        continue
    compared += 1
    if int(message.get("MessageID")) != dump[2]:
        print("differs: MessageID", index)
    compare(message, dump, "%d" % index)
print("compared", compared)
