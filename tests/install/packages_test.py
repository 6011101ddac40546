"""packages_test.py BUILD SOURCE WORK CPACK CXX FLAGS: builds the Debian packages of a build tree, asks lintian, unpacks
them into an empty root, and builds and runs programs against what is there.  Exit code 77: a tool is missing."""

import functools
import glob
import gzip
import os
import re
import shutil
import subprocess
import sys

BUILD, SOURCE, WORK, CPACK, CXX, FLAGS = sys.argv[1:7]
ROOT = os.path.join(WORK, "root")
IN_CI = os.environ.get("CI") == "true"


def run(*command, **options):
    done = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit {done.returncode}\n{done.stdout}")
    return done.stdout


def expect(what, condition, shown=""):
    if not condition:
        sys.exit(f"{what}\n{shown}")


def need(tool):
    if shutil.which(tool) is None:
        if IN_CI:
            sys.exit(f"{tool} is missing: .ci/packages.txt has it")
        print(f"skipped: {tool} is missing")
        sys.exit(77)


def field(deb, name):
    return run("dpkg-deb", "-f", deb, name).strip()


def names(relation):
    """Packages of a Depends field: of alternatives the first."""
    return {re.split(r"[ |(:]", part.strip())[0] for part in relation.split(",") if part.strip()}


def installed_packages():
    """Of this machine: package -> what it depends on; virtual ones lead to those that provide them."""
    depends = {}
    text = run("dpkg-query", "-W", "-f", "${Package}\t${Depends}, ${Pre-Depends}\t${Provides}\n")
    for line in text.splitlines():
        name, needs, provides = line.split("\t")
        depends.setdefault(name, set()).update(
            re.split(r"[ (:]", part.strip())[0]
            for group in needs.split(",") for part in group.split("|") if part.strip())
        for virtual in names(provides):
            depends.setdefault(virtual, set()).add(name)
    return depends


def closure(packages, depends):
    found, left = set(), list(packages)
    while left:
        name = left.pop()
        if name not in found:
            found.add(name)
            left += depends.get(name, ())
    return found


@functools.lru_cache(maxsize=None)
def owners():
    """Which package has which shared library: by path, /lib taken for /usr/lib."""
    found = {}
    for path in glob.glob("/var/lib/dpkg/info/*.list"):
        package = os.path.basename(path)[:-len(".list")].split(":")[0]
        with open(path, encoding="utf-8") as file:
            for line in file:
                if ".so" in line:
                    found[merged(line.strip())] = package
    return found


def merged(path):
    return os.path.join(os.path.realpath(os.path.dirname(path)), os.path.basename(path))


def owner(path):
    """The package that has a shared library; alternatives (libblas.so.3) are followed."""
    return owners().get(merged(path)) or owners().get(os.path.realpath(path))


def build_packages():
    folder = os.path.join(WORK, "packages")
    shutil.rmtree(WORK, ignore_errors=True)
    os.makedirs(WORK)
    run(CPACK, "--config", os.path.join(BUILD, "CPackConfig.cmake"), "-G", "DEB", "-B", folder, cwd=BUILD)
    debs = {field(deb, "Package"): deb for deb in glob.glob(os.path.join(folder, "*.deb"))}
    expect("packages", {"graticule", "libgraticule-dev"} <= set(debs), debs)
    return debs


def check_lintian(debs):
    if shutil.which("lintian") is None and not IN_CI:
        print("lintian is missing: not asked")
        return
    need("lintian")
    user = [] if os.geteuid() else ["--allow-root"]
    done = subprocess.run(["lintian", *user, "--fail-on", "error", *debs.values()], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    print(done.stdout)
    expect("lintian found errors", done.returncode == 0)


def check_content(debs):
    for name, deb in debs.items():
        for what in ("Version", "Architecture", "Maintainer", "Section", "Priority", "Description"):
            expect(f"{name} has no {what}", field(deb, what))
        control = run("dpkg-deb", "-I", deb)
        expect(f"{name} has no md5sums", "md5sums" in control, control)
        listing = run("dpkg-deb", "-c", deb)
        doc = f"./usr/share/doc/{name}/"
        for file in ("copyright", "changelog.Debian.gz"):
            expect(f"{name} has no {file}", doc + file in listing, listing)
        for line in listing.splitlines():
            mode, who = line.split()[:2]
            expect(f"{name}: owner", who == "root/root", line)
            expect(f"{name}: others may write", mode[8] != "w" or mode[0] == "l", line)
        run("dpkg-deb", "-x", deb, ROOT)
        with gzip.open(os.path.join(ROOT, doc, "changelog.Debian.gz"), "rt") as changelog:
            expect("changelog", f"({field(deb, 'Version')})" in changelog.readline())
    for file in ("bin/graticule", "bin/graticule-vision", "share/man/man1/graticule-solve.1.gz",
                 "share/man/man1/graticule-vision.1.gz", "share/bash-completion/completions/graticule",
                 "share/graticule/configs/default.yaml", "include/graticule/solver/solve.hpp",
                 *(f"share/doc/libgraticule-dev/examples/{name}"
                   for name in ("embed/main.cpp", "plugin/radar.cpp", "lens/division.cpp",
                                "ros2_node/mapper.cpp", "ros2_node/package.xml", "ros2_node/CMakeLists.txt"))):
        expect(f"{file} is in no package", os.path.exists(os.path.join(ROOT, "usr", file)))


def check_runs(debs, depends):
    """Every shared library that the programs load is in a package that Depends leads to."""
    allowed = closure(names(field(debs["graticule"], "Depends")) | {"libc6"}, depends)
    for name in ("graticule", "graticule-vision", *(["graticule-mpi"] if "graticule-mpi" in debs else [])):
        if name == "graticule-mpi":
            allowed |= closure(names(field(debs[name], "Depends")), depends)
        program = os.path.join(ROOT, "usr/bin", name)
        expect("stripped", ".debug_info" not in run("readelf", "-S", program) and
               ".symtab" not in run("readelf", "-S", program))
        for line in run("ldd", program).splitlines():
            match = re.search(r"=> (/\S+)", line)
            if match:
                package = owner(match[1])
                expect(f"{name} loads {match[1]} of {package}: not in Depends", package in allowed)
            else:
                expect(line, "not found" not in line)
    environment = {key: value for key, value in os.environ.items() if not key.startswith("GRATICULE_")}
    graticule = os.path.join(ROOT, "usr/bin/graticule")
    versions = run(graticule, "--version", env=environment)
    for what in ("ceres", "eigen", "suitesparse", "opencv", "plugin-abi"):
        expect(f"--version does not say {what}", re.search(rf"^  {what} \d", versions, re.M), versions)
    problem = os.path.join(WORK, "city.fg")
    run(graticule, "simulate", "city", "--robots", "2", "--poses", "50", "-o", problem, env=environment)
    run(graticule, "solve", problem, "--config", "robust-huber", "--plot", os.path.join(WORK, "c.png"),
        env=environment)
    if "graticule-mpi" in debs:
        check_launched(debs, graticule, problem, environment)
    scene = os.path.join(WORK, "scene")
    run(graticule, "simulate", "scene", "hallway", "-o", scene, env=environment)  # by graticule-vision
    expect("the scene was not written", os.path.exists(os.path.join(scene, "scan.pcd")))


def check_launched(debs, graticule, problem, environment):
    """Of one version with the program, which becomes graticule-mpi under a launcher."""
    version = field(debs["graticule"], "Version")
    depends = field(debs["graticule-mpi"], "Depends")
    expect("graticule-mpi depends on its program", f"graticule (= {version})" in depends, depends)
    expect("graticule-mpi depends on MPI", "openmpi" in depends, depends)
    for file in ("bin/graticule-mpi", "share/man/man1/graticule-mpi.1.gz"):
        expect(f"{file} is in no package", os.path.exists(os.path.join(ROOT, "usr", file)))
    if shutil.which("mpirun"):
        said = run("mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-n", "2", graticule, "compare", problem,
                   "--configs", "default", "dogleg",
                   env=dict(environment, OMPI_MCA_btl_vader_single_copy_mechanism="none"))
        expect("compare by mpirun", "dogleg" in said, said)


def check_develops(debs, depends):
    """By CMake and by pkg-config: embedder, plug-in, and a program that uses every room."""
    usr = os.path.join(ROOT, "usr")
    allowed = closure(names(field(debs["libgraticule-dev"], "Depends")) | {"g++", "libc6-dev"}, depends)
    missing = names(field(debs["libgraticule-dev"], "Depends")) - set(depends)
    expect(f"libgraticule-dev depends on {missing}, which is not here", not missing)

    pc_files = glob.glob(os.path.join(usr, "lib/**/pkgconfig/*.pc"), recursive=True)
    expect("there are no .pc files", pc_files)
    # A root that is moved, and a path with that root only in front: headers and libraries of ours come from there.
    environment = dict(os.environ, PKG_CONFIG_PATH=os.path.dirname(pc_files[0]))

    def flags(component):
        return run("pkg-config", "--cflags", "--libs", component, env=environment).split()

    for library in re.findall(r"(?<= )-l(\S+)", " " + " ".join(flags("graticule-problems"))):
        if not library.startswith("graticule") and library != "dl":  # part of libc
            file = run(CXX, f"-print-file-name=lib{library}.so").strip()
            package = owner(file)
            expect(f"-l{library} ({file}) is in {package}: not in Depends", package in allowed)

    embed = os.path.join(WORK, "embed")
    run(CXX, "-std=c++17", *FLAGS.split(), os.path.join(SOURCE, "docs/examples/embed/main.cpp"), "-o", embed,
        *flags("graticule"))
    said = run(embed)
    expect("embed by pkg-config", "converged after" in said, said)

    rooms = os.path.join(WORK, "rooms")
    run(CXX, "-std=c++17", *FLAGS.split(), os.path.join(SOURCE, "tests/install/rooms/main.cpp"), "-o", rooms,
        *flags("graticule-problems"))
    said = run(rooms, os.path.join(WORK, "rooms.fg"))
    expect("rooms by pkg-config", "converged" in said, said)

    plugin = os.path.join(WORK, "libradar.so")
    run(CXX, "-std=c++17", "-shared", "-fPIC", "-fvisibility=hidden", *FLAGS.split(),
        os.path.join(SOURCE, "docs/examples/plugin/radar.cpp"), "-o", plugin, *flags("graticule-sdk"))
    graticule = os.path.join(usr, "bin/graticule")
    problem = os.path.join(SOURCE, "docs/examples/plugin/problem.fg")
    run(graticule, "check", "--plugin", plugin, problem)
    folder = run("pkg-config", "--variable=plugindir", "graticule-sdk", env=environment).strip()
    expect("the folder for plug-ins", os.path.isdir(folder), folder)
    shutil.copy(plugin, folder)
    run(graticule, "solve", problem)  # found without a word

    # CMake: what its files lead to is found, with the packages that Depends names.
    example = os.path.join(WORK, "cmake")
    shutil.copytree(os.path.join(SOURCE, "docs/examples/embed"), example)
    run("cmake", "-S", example, "-B", example + "/build", f"-DCMAKE_PREFIX_PATH={usr}",
        f"-DCMAKE_CXX_COMPILER={CXX}", f"-DCMAKE_CXX_FLAGS={FLAGS}")
    run("cmake", "--build", example + "/build")
    expect("embed by CMake", "converged after" in run(example + "/build/embed"))


def main():
    for tool in ("dpkg-deb", "dpkg-shlibdeps", "dpkg-query", "pkg-config", "readelf"):
        need(tool)
    debs = build_packages()
    depends = installed_packages()
    check_content(debs)
    check_runs(debs, depends)
    check_develops(debs, depends)
    check_lintian(debs)
    shutil.rmtree(WORK)


if __name__ == "__main__":
    main()
