"""Prints the folder below PREFIX for a compiled module: the first where this Python looks for modules by itself. Where it
looks nowhere below PREFIX, the one of its default layout, and says on standard error how to have the module found.

    python3 -I place.py PREFIX
"""
import site
import sys
import sysconfig

prefix = sys.argv[1].rstrip("/")
# Not /usr/local/lib for /usr.
searched = [folder for folder in site.getsitepackages() + sys.path
            if folder.startswith(f"{prefix}/lib") and folder.endswith("-packages")]
place = searched[0] if searched else sysconfig.get_path("platlib", "posix_prefix", {"base": prefix, "platbase": prefix})
if not searched:
    print(f"The Python module is in {place}, where {sys.executable} does not look by itself: set PYTHONPATH={place}",
          file=sys.stderr)
print(place)
