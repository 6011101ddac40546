"""site_test.py SOURCE WORK: the documentation as a site, by mkdocs --strict.  Every page is in the navigation, every
link with a place in a page finds it, and nothing is fetched from a network.  Exit code 77: mkdocs is missing."""

import html.parser
import os
import re
import shutil
import subprocess
import sys
from urllib.parse import unquote, urldefrag, urljoin, urlparse

SOURCE, WORK = sys.argv[1:3]


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.ids, self.links, self.loaded, self.text = set(), [], [], []
        self.in_code = 0
        with open(path, encoding="utf-8") as file:
            self.feed(file.read())

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.in_code += tag in ("code", "pre", "script", "style")
        if values.get("id"):
            self.ids.add(values["id"])
        if tag == "a" and values.get("href"):
            self.links.append(values["href"])
        if tag == "link" and values.get("rel") not in ("canonical", "next", "prev"):
            self.loaded.append(values.get("href"))
        if tag in ("script", "img", "iframe") and values.get("src"):
            self.loaded.append(values["src"])

    def handle_endtag(self, tag):
        self.in_code -= tag in ("code", "pre", "script", "style")

    def handle_data(self, data):
        if not self.in_code:
            self.text.append(data)


def mkdocs():
    """The command: Debian's Python has it, whichever other one is first on the path."""
    path = shutil.which("mkdocs")
    if path is None:
        if os.environ.get("CI") == "true":
            sys.exit("mkdocs is missing: .ci/packages.txt has it")
        print("skipped: mkdocs is missing (apt-get install mkdocs mkdocs-material)")
        sys.exit(77)
    return path


def main():
    program = mkdocs()
    site = os.path.join(WORK, "site")
    shutil.rmtree(site, ignore_errors=True)
    done = subprocess.run([program, "build", "--strict", "-f",
                           os.path.join(SOURCE, "mkdocs.yml"), "-d", site],
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"mkdocs build --strict: exit {done.returncode}\n{done.stdout}{done.stderr}")
    if "not included in the \"nav\" configuration" in done.stdout + done.stderr:
        sys.exit(done.stdout + done.stderr)

    pages = {}
    for folder, _, names in os.walk(site):
        for name in names:
            if name.endswith(".html"):
                path = os.path.join(folder, name)
                pages[os.path.relpath(path, site)] = Page(path)
    faults = []
    for name, page in pages.items():
        for url in page.loaded:
            if urlparse(url).netloc:
                faults.append(f"{name}: loads {url}")
        if name == "404.html":
            continue
        for link in page.links:
            url, place = urldefrag(link)
            if urlparse(link).scheme or urlparse(link).netloc:
                continue
            target = name if not url else urlparse(urljoin("http://s/" + name, url)).path[1:]
            if target == "" or target.endswith("/"):
                target += "index.html"
            target = unquote(target)
            if target in pages:
                if place and unquote(place) not in pages[target].ids:
                    faults.append(f"{name}: {link}: there is no such place")
            elif not os.path.exists(os.path.join(site, target)):
                faults.append(f"{name}: {link}: there is no such file")
        for line in "".join(page.text).splitlines():
            if re.match(r"\s*(\||[-*] |\d\. \S.*\d\. |```)", line):
                faults.append(f"{name}: not read as Markdown: {line[:60]}")
    for folder, _, names in os.walk(site):
        for name in names:
            if name.endswith(".css"):
                with open(os.path.join(folder, name), encoding="utf-8") as file:
                    for url in re.findall(r"(?:@import|url\()\s*['\"]?(https?:[^'\")]*)", file.read()):
                        faults.append(f"{name}: loads {url}")
    if len(pages) < 20:
        faults.append(f"only {len(pages)} pages")
    sys.exit("\n".join(faults) if faults else 0)


if __name__ == "__main__":
    main()
