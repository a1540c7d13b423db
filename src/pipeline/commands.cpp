// The subcommands, in the order of Command and of help.
#include <array>

#include "pipeline/command_line.h"

namespace selvage::pipeline {

namespace {

using enum Command;

// Texts of the examples are those of `selvage new`; tests run them, one command's after the other's.
constexpr std::array commands = {
    Subcommand{convert, "convert", "write surfaces, solids or text",
               "selvage convert twill.txt\n"
               "selvage convert twill.txt -o twill.stp\n"
               "selvage convert jersey.txt rib.txt --to iges,step -o out"},
    Subcommand{check, "check", "closed? valid? overlapping? within tolerance? (exit code 3: no)",
               "selvage check twill.txt\n"
               "selvage check twill.igs twill.stp -v --report check.json"},
    Subcommand{relax, "relax", "move and reshape yarns until none overlap (exit code 3: no solution)",
               "selvage relax yarns.txt --gap 0.05 -o apart.txt"},
    Subcommand{mesh, "mesh",
               "tetrahedra in every yarn, or in a unit cell with its matrix, as a solver's input deck",
               "selvage mesh yarns.txt -o yarns.inp\n"
               "selvage mesh cell.txt --matrix --periodic --voxel 20 -o cell.inp"},
    Subcommand{roundtrip, "roundtrip",
               "write, read back and compare, for every surface format (exit code 3: different)",
               "selvage roundtrip yarns.txt --to iges,txt"},
    Subcommand{diff, "diff", "compare the geometry of two files (exit code 3: they differ)",
               "selvage diff twill.txt twill.igs\n"
               "selvage diff twill.igs twill.stp --tolerance 1e-6"},
    Subcommand{info, "info", "what is in a file: yarns, sizes, units, lengths",
               "selvage info twill.txt\n"
               "selvage info twill.igs --json\n"
               "selvage info jersey.txt --report info.json"},
    Subcommand{edit, "edit", "move a point of a yarn: adds an `edit` line to a text",
               "selvage edit yarns.txt --yarn lower --point 2 --to 0,0,-0.2 -o moved.txt"},
    Subcommand{view, "view", "a picture of yarns, meshes or results (PNG), or a page to turn them on (HTML)",
               "selvage view twill.txt --from iso -o twill.png\nselvage view twill.txt -o twill.html"},
    Subcommand{
        sweep, "sweep",
        "check, convert or mesh an input with many values of its params, and make a table of the results",
        "selvage sweep yarns.txt --set half=0.16:0.2:0.02 --csv gaps.csv"},
    Subcommand{report, "report", "join the reports of several runs (merge), or show them on a page (html)",
               "selvage report html check.json -o report.html\n"
               "selvage report merge check.json info.json -o all.json"},
    Subcommand{formats, "formats", "the formats that can be read and written", "selvage formats"},
    Subcommand{new_text, "new", "a text to begin with, with comments; without KIND the kinds that there are",
               "selvage new\n"
               "selvage new denim -o denim.txt"},
    Subcommand{explain, "explain", "a word of the texts, an exit code, or what a result means",
               "selvage explain twist\n"
               "selvage explain 3"},
    Subcommand{help, "help", "of a subcommand, or of a topic such as units, weave, cell, exit-codes",
               "selvage help mesh\n"
               "selvage help units"},
    Subcommand{show_version, "version", "the version of the program", "selvage version"}};

}  // namespace

std::string_view name_of(Command command) {
  return commands[static_cast<std::size_t>(command)].name;
}

std::span<const Subcommand> all_commands() {
  return commands;
}

}  // namespace selvage::pipeline
