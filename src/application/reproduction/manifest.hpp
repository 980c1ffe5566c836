// The manifest of figures: what each was made from, with the SHA-256 of every file, and the stamp that leads
// from a picture back to all that. Kept in data/reference/manifest.json, made by paper/describe:
//
//   {"schema": "impact-damper/manifest/1",
//    "software": {"title": "impact-damper", "version": "0.1.0", "year": 2026, "license": "MIT",
//                 "authors": ["..."]},
//    "paper": {"title": "...", "note": "..."},
//    "figures": [{"figure": "8", "title": "...", "stamp": "1a2b3c4d · 0.1.0",
//                 "scenes": [{"file": "data/scenes/nu1-e06.json", "sha256": "..."}],
//                 "tables": [{"engine": "exact", "file": "data/reference/series/fig08.dat",
//                             "sha256": "1a2b3c4d...", "swhid": "swh:1:cnt:..."},
//                            {"engine": "restitution", ...}, {"engine": "cem", ...}],
//                 "csv": {"file": "build/series/exact/fig08.csv", "sha256": "..."},
//                 "script": {"file": "figures/fig08.gp", "sha256": "..."},
//                 "picture": {"file": "data/reference/figures/fig08.svg", "sha256": "..."},
//                 "claims": ["..."]}]}
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/io/json_reader.hpp"

namespace impact_damper {

struct CitedFile {
  std::string file;    // relative to the source folder
  std::string sha256;  // 64 hexadecimal digits in lower case
  std::string swhid;   // "swh:1:cnt:" and git's hash of the content; empty if the manifest has none
};

struct CitedTable {
  std::string engine;  // whose runs it was made from
  CitedFile content;
};

struct CitedFigure {
  std::string number, title;
  // Eight digits and the version, "1a2b3c4d · 0.1.0": the first of the SHA-256 of the first table; of the
  // script for a drawing.
  std::string stamp;
  std::vector<CitedFile> scenes;
  std::vector<CitedTable>
      tables;  // none for a drawing; else the exact engine's, which the picture shows, first
  std::optional<CitedFile> csv;  // the first table as CSV; absent in a manifest older than that file
  CitedFile script, picture;
  std::vector<std::string> claims;
};

struct Manifest {
  std::string title, version, license;
  std::vector<std::string> authors;  // at least one
  std::int64_t year = 0;             // four digits
  std::string paper_title, paper_note;
  std::vector<CitedFigure> figures;
};

// Throws IoError if the file cannot be read, InputError if it is not valid, as with a figure given twice or a
// stamp that is not its table's.
inline constexpr FileKind manifest_kind{"manifest", 1 << 20};
Manifest read_manifest(const std::filesystem::path& file);
Manifest parse_manifest(const std::string& name, const std::string& text);

// The stamp of a picture, as a user types it.
struct Stamp {
  std::string digits;                  // 8 to 64, in lower case: of a stamp, or more of the same SHA-256
  std::optional<std::string> version;  // if it was given, too
};
// Reads "1a2b3c4d · 0.1.0", with or without dot and version, in either case; absent if `text` is no stamp.
std::optional<Stamp> parse_stamp(std::string_view text);

// A figure and the table of its own that carries the stamp; a null pointer for a drawing.
struct Stamped {
  const CitedFigure* figure = nullptr;
  const CitedTable* table = nullptr;
};
// Returns every table, and every drawing by its script, whose SHA-256 begins with the digits; the exact
// engine's come first within a figure. Valid as long as the manifest.
std::vector<Stamped> find_stamped(const Manifest& manifest, std::string_view digits);

}  // namespace impact_damper
