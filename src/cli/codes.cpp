#include "cli/codes.h"

#include "cad/compare.h"
#include "core/diagnostics.h"

namespace selvage::cli {

namespace {

constexpr std::string_view of_errors = "a kind of error", of_severity = "a message",
                           of_differences = "a difference (selvage diff)",
                           of_sweeps = "a result (selvage sweep)", of_checks = "a finding (selvage check)";

Code code(std::string_view word, std::string_view where, std::string_view meaning, std::string_view remedy) {
  return {std::string(word), std::string(where), std::string(meaning), std::string(remedy)};
}

// Neither switch has a default: what is new does not compile until it is explained.
Code explained(Kind kind) {
  const auto made = [&](std::string_view meaning, std::string_view remedy) {
    return code(name_of(kind), of_errors, meaning, remedy);
  };
  switch (kind) {
    case Kind::malformed:
      return made("The input breaks its format's rules; the message says in which line and column.",
                  "Mend that place, or write the file anew where it comes from.");
    case Kind::unsupported:
      return made("The input is well formed, but says what this version does not do.",
                  "Leave it out, say it in another way, or take a newer version.");
    case Kind::io:
      return made("The system refused: a file is missing, may not be read or written, or the disk is full.",
                  "Look at the path, its permissions and the space that is left.");
    case Kind::geometry:
      return made("The shape is impossible or defective: yarns without room, bends tighter than the yarn.",
                  "Change the number that the message names; it says what has room.");
    case Kind::limit:
      return made("A size, the time or the memory would be passed.",
                  "Give more by --timeout or --memory, or ask for less: larger --size, --digits short.");
    case Kind::usage:
      return made("The command line is wrong; nothing was done.",
                  "`selvage COMMAND --help` lists the options, and what goes together.");
    case Kind::internal:
      return made("The program's own fault: a worker crashed, or a check of its reasoning failed.",
                  "Report it with the input, the command line and `selvage --version`.");
    case Kind::interrupted:
      return made("Ctrl-C, or another signal, ended the run; what was done is whole.",
                  "Run it again; --resume with --report skips what was done.");
  }
  return {};
}

Code explained(cad::Difference::Kind kind) {
  const auto made = [&](std::string_view meaning) {
    return code(cad::name_of(kind), of_differences, meaning, "");
  };
  switch (kind) {
    case cad::Difference::Kind::added:
      return made("B has a yarn, part or curve that A does not have.");
    case cad::Difference::Kind::removed:
      return made("A has a yarn, part or curve that B does not have.");
    case cad::Difference::Kind::moved:
      return made("The same shape stands elsewhere: the line says by which vector, and how it is turned.");
    case cad::Difference::Kind::reshaped:
      return made("The shape differs: the line says which control point, or where, and by how much.");
    case cad::Difference::Kind::renamed:
      return made("The same geometry has another name.");
    case cad::Difference::Kind::recoloured:
      return made("The same geometry has another colour.");
  }
  return {};
}

}  // namespace

std::vector<Code> all_codes() {
  std::vector<Code> codes = {
      code("0", exit_codes, "All well.", ""),
      code("1", exit_codes, "At least one input failed; the others were done.",
           "The messages above name the inputs; --report has them all."),
      code("2", exit_codes, "The command line is wrong; nothing was done.",
           "The message says what; `selvage COMMAND --help` lists the options."),
      code("3", exit_codes,
           "check found a defect, diff or roundtrip a difference, or relax no solution; all inputs could be "
           "read.",
           "Of overlaps: `selvage relax`. Of differences: `selvage help diff` (--tolerance)."),
      code("130", exit_codes, "Interrupted (Ctrl-C); what was done is whole.",
           "Run it again; --resume with --report skips what was done."),
      code("note", of_severity, "Worth knowing; -v shows it.", ""),
      code("warning", of_severity, "Done, but perhaps not as meant.",
           "Follow its remedy; with --strict warnings fail their input."),
      code("error", of_severity, "What it names was not done.", "Follow its remedy.")};
  for (const Kind kind : {Kind::malformed, Kind::unsupported, Kind::io, Kind::geometry, Kind::limit,
                          Kind::usage, Kind::internal, Kind::interrupted})
    codes.push_back(explained(kind));
  using Difference = cad::Difference::Kind;
  for (const Difference kind : {Difference::added, Difference::removed, Difference::moved,
                                Difference::reshaped, Difference::renamed, Difference::recoloured})
    codes.push_back(explained(kind));
  for (const Code& one :
       {code("ok", of_sweeps, "The variant was done, without a defect.", ""),
        code("defect", of_sweeps, "The variant was built, and is defective; exit code 3.",
             "The table's last column has the first error."),
        code("failed", of_sweeps, "The variant could not be done; exit code 1.",
             "The table's last column has the first error."),
        code("not done", of_sweeps, "The run was stopped before, or another --shard does it.",
             "--resume goes on."),
        code("sound", of_checks, "Every yarn is closed and valid, within its tolerance, and none overlap.",
             ""),
        code("overlap", of_checks,
             "Two yarns, or two places of one, share space: how deep, where, and which way leads out.",
             "`selvage relax`, --relax with convert and mesh, larger pitches, or thinner yarns."),
        code("closed", of_checks, "A yarn's surface and its ends leave no gap; yes or no.",
             "Ends are sealed by `ends` of the yarn, or --ends."),
        code("gap", of_checks, "The least distance between two yarns; negative: they overlap.",
             "`selvage check --reach G` lists where it is small.")})
    codes.push_back(one);
  return codes;
}

}  // namespace selvage::cli
