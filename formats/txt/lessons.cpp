#include "formats/txt/lessons.h"

#include <array>

namespace selvage::formats::txt {

namespace {

// In the order of formats/txt/README.md, which has what is more than a sentence.
constexpr std::array lessons = {
    // --- the file
    Lesson{"fabric", "file", "fabric 1", "The first statement: the version of the language.", "fabric 1"},
    Lesson{"title", "file", "title \"TEXT\"", "What the fabric is called in outputs.",
           "title \"Plain weave\""},
    Lesson{"units", "file", "units m | cm | mm | um | inch",
           "The unit of every length in the file without one of its own; outputs keep it.", "units cm", "",
           "mm"},
    Lesson{
        "param", "file", "param NAME VALUE",
        "A value that lines below may name, also in expressions; --set and `selvage sweep` give it others.",
        "param sett 24/cm"},
    Lesson{"tolerance", "file block", "tolerance T",
           "The largest distance between the modelled tube and its B-spline surface, above 0.",
           "tolerance 0.001", "length", "1/1000 of the smallest section size"},
    Lesson{"thread", "file block", "thread NAME ... end",
           "What a yarn is made of: count, fibre, section, twist.", "thread cotton"},
    Lesson{"material", "file block", "material NAME ... end",
           "Density, packing, stiffness, expansion and conductivities, by a name that threads and the cell's "
           "matrix refer to.",
           "material epoxy"},
    Lesson{"outline", "file block", "outline NAME ... end",
           "A section by the control points of a closed quadratic: rows `x y`, at least 3.", "outline flat"},
    Lesson{"yarn", "file block", "yarn NAME [THREAD] ... end",
           "One yarn by its centre line, or by its control points.", "yarn tow_1 carbon"},
    Lesson{"weave", "file block", "weave ... end", "A woven cloth: warps along x, wefts along y.", "weave"},
    Lesson{
        "knit", "file block",
        "knit [jersey | purl | rib AxB | interlock | full-cardigan | half-cardigan | milano | half-milano | "
        "jacquard] ... end",
        "A weft knit: wales along y, courses along x; without a word by its `chart`. `single jersey` and "
        "`single-jersey` are the jersey; a `spacer` is a chart of two faces.",
        "knit jersey"},
    Lesson{"warpknit", "file block",
           "warpknit [tricot | cord | satin | velvet | locknit | queens-cord | atlas] ... end",
           "A warp knit by its bars; with a word one of the classics.", "warpknit"},
    Lesson{"braid", "file block", "braid ... end", "A tube, a strip, a planar braid, or one on a mandrel.",
           "braid"},
    Lesson{
        "piece", "file", "piece NAME ... end",
        "The outline of a garment pattern in z = 0, in order: each part begins where the one before it ends.",
        "piece front"},
    Lesson{"block", "file block", "block NAME ... end",
           "A fabric by name, without yarns by itself; `use` puts it somewhere.", "block ply"},
    Lesson{"use", "file block", "use NAME | file NAME [as PREFIX] ... end",
           "The yarns of a block, or of another file, placed, turned and repeated.", "use ply as top"},
    Lesson{"edit", "file block",
           "edit YARN point K to X Y Z | weight K to X Y Z | length L point K along X Y Z",
           "Moves the K-th joint (from 1) of a yarn's centre line; edits apply in their order.",
           "edit warp_1 point 3 to 1 0.5 -0.2", "length"},
    Lesson{
        "cell", "file", "cell X Y Z  X Y Z | repeat [NX x NY] | vectors A B [C] [at X Y Z] ... end",
        "The unit cell, between two opposite corners, of NX by NY repeats, or along edges at any angle, for "
        "--cut, --matrix, --periodic.",
        "cell repeat 2 x 1", "length"},

    // --- thread
    Lesson{"tex", "thread yarn", "tex V",
           "Linear density, g/km, written as dtex is; it sizes a circle with density and packing.",
           "tex 29.5"},
    Lesson{"dtex", "thread yarn", "dtex V[/N][ fN][ xN]",
           "Linear density, g/10 km, of a single yarn; behind / a number above 9 is that of filaments, any "
           "other one "
           "that of plies, which multiply it. With `plies` alone it is that of the whole yarn. `f` or `fil` "
           "marks the filaments, "
           "R a resultant count; Tt may stand in front.",
           "dtex 167 f48 x2"},
    Lesson{"denier", "thread yarn", "denier V[/N][ fN][ xN]",
           "Linear density, g/9 km, written as dtex is; `denier 20/22` is a raw silk's range.",
           "denier 150/48"},
    Lesson{"Td", "thread yarn", "Td V", "Linear density, g/9 km: another word for denier.", "Td 150"},
    Lesson{"Nm", "thread yarn", "Nm V[/N]",
           "Metric count, km/kg, of a single yarn; of two numbers the smaller one is that of plies, which "
           "divide it, and `ply` may follow them. "
           "With `plies` alone it is that of the whole yarn.",
           "Nm 2/60"},
    Lesson{"Ne", "thread yarn", "Ne V[/N]",
           "English cotton count, hanks of 840 yards a pound, of a single yarn; of two numbers the smaller "
           "one is that "
           "of plies, which divide it, and `ply` may follow them. With `plies` alone it is that of the whole "
           "yarn.",
           "Ne 30/2"},
    Lesson{"density", "thread yarn material", "density V", "Density of the fibre.", "density 1.52", "density",
           "what the material says"},
    Lesson{"packing", "thread yarn material", "packing V",
           "The share of the section that is fibre, 0 < V <= 1; of a thread it sizes a circle.",
           "packing 0.6", "", "1 with `filaments 1`, else what the material says"},
    Lesson{"diameter", "thread yarn", "diameter D",
           "Of a circle, instead of the one that follows from count, density and packing.", "diameter 0.3",
           "length", "sqrt(tex / (250 pi density packing)) mm"},
    Lesson{"section", "thread yarn",
           "section circle [D] | ellipse W H | lenticular W H | racetrack W H | power W H N | loop7 [D] | "
           "polygon",
           "The yarn's cross-section: W across, H thick.", "section ellipse 0.8 0.2", "length", "circle"},
    Lesson{"twist", "thread yarn", "twist TURNS Z | S [rotate]",
           "Turns, 0 or more, and their direction: it marks the fibres.", "twist 600 Z", "twist"},
    Lesson{"plies", "thread yarn", "plies N TURNS Z | S",
           "A ply yarn of N single yarns, with its ply twist; the count is that of the whole yarn.",
           "plies 2 400 S", "twist"},
    Lesson{"filaments", "thread yarn", "filaments N",
           "Filaments of each single yarn: each becomes a yarn of its own, up to 300; more with --detail "
           "filaments.",
           "filaments 19"},
    Lesson{"color", "thread yarn", "color R G B | #RRGGBB | #RGB | NAME",
           "0 to 255 each, or a name of CSS; `indigo` is a denim's.", "color navy"},
    Lesson{"colour", "thread yarn", "colour R G B | #RRGGBB | #RGB | NAME", "Another word for color.",
           "colour navy"},
    Lesson{"material", "thread yarn", "material NAME", "A `material` block, or a fibre of the trade.",
           "material cotton"},

    // --- material
    Lesson{"elastic", "material", "elastic isotropic E NU | transverse E1 E2 NU12 G12 NU23",
           "Stiffness; 1 is along the yarn. -1 < NU < 0.5.", "elastic isotropic 3400 0.35", "modulus"},
    Lesson{"strength", "material", "strength isotropic T C [S] | transverse XT XC [YT YC S12 [S23]]",
           "The largest stresses: tension, compression, shear; X along the yarn, Y across it.",
           "strength isotropic 80 120 60", "modulus"},
    Lesson{"expansion", "material", "expansion ALONG ACROSS", "Thermal expansion.", "expansion 6e-6 21e-6",
           "expansion"},
    Lesson{"conductivity", "material", "conductivity K | ALONG ACROSS",
           "Of heat, in all directions or along and across the yarn, for `mesh --physics conduction`.",
           "conductivity 6.5 0.8", "conductivity"},
    Lesson{"diffusivity", "material", "diffusivity D | ALONG ACROSS",
           "Of moisture or another substance, for `mesh --physics diffusion`.", "diffusivity 4e-7",
           "diffusivity"},
    Lesson{"permittivity", "material", "permittivity E | ALONG ACROSS",
           "Over that of a vacuum, 1 or more, for `mesh --physics permittivity`.", "permittivity 6.1"},
    Lesson{"interface", "material", "interface ... end",
           "How the material holds on to another one where it ends, for `mesh --interface cohesive`.",
           "interface", "", "as stiff as if it were bonded, and nothing breaks"},
    Lesson{"stiffness", "interface", "stiffness NORMAL SHEAR",
           "Traction by opening, MPa/mm, across the interface and along it.", "stiffness 1e6 1e6", "",
           "so much that the whole is as stiff as a bonded one to a thousandth"},
    Lesson{"strength", "interface", "strength NORMAL SHEAR",
           "The largest traction, across the interface and along it; with `energy`.", "strength 40 60",
           "modulus"},
    Lesson{"energy", "interface", "energy NORMAL SHEAR",
           "What it takes to part it, N/mm (kJ/m2), by opening and by sliding; with `strength`.",
           "energy 0.2 0.8"},

    // --- yarn
    Lesson{"role", "yarn", "role warp | weft | wale | course | braider | axial | binder | other",
           "What the yarn is in its cloth: outputs tell them apart by it.", "role warp", "", "other"},
    Lesson{"path", "yarn",
           "path [chord | uniform | centripetal | polyline | control | loop | smooth E] ... end",
           "The centre line: rows `x y z [W H [ANGLE]]`, at least 2, then perhaps `outline A [B SHARE] "
           "[weight W]`, `fixed`.",
           "path", "length", "chord"},
    Lesson{"grid", "yarn", "grid S P ... end",
           "The surface itself: S sections of P control points, rows `x y z [WEIGHT]`.", "grid 12 8",
           "length"},
    Lesson{"points", "yarn", "points FILE [yarn NAME] [error E]",
           "The centre line from a file of points (CSV, VTP), smoothed within E.",
           "points tows.csv error 0.05", "length"},
    Lesson{"helix", "yarn", "helix radius R pitch P turns N [left | right] [start ANGLE]",
           "Round the z axis, from z = 0 to N P.", "helix radius 3 pitch 1.2 turns 6", "length"},
    Lesson{"closed", "yarn", "closed", "The yarn is a ring without ends.", "closed"},
    Lesson{"group", "yarn", "group NAME", "The yarn is a ply or filament of the yarn NAME.", "group warp_1"},
    Lesson{"tangent", "yarn", "tangent start | end X Y Z",
           "The direction at an end of an open path through data points.", "tangent start 1 0 0"},
    Lesson{
        "derivative", "yarn", "derivative start | end X Y Z",
        "The derivative at that end, by the parameter from 0 to 1: the longer, the farther the path follows.",
        "derivative end 3 0 -2", "length"},
    Lesson{"up", "yarn", "up X Y Z", "The thickness direction of a path's first section.", "up 0 1 0", "",
           "+z, or +y where the path runs along z"},
    Lesson{"ends", "yarn", "ends patch | fan | planar | none [the same of the end]",
           "How its ends are sealed; --ends overrides it.", "ends planar", "", "patch"},
    Lesson{"knots", "path curve", "knots K ...",
           "Of a `path control` or a curve that is a B-spline: as many as rows and four more, of a curve "
           "from 0 to 1.",
           "knots 0 0 0 0 1 1 1 1", "", "clamped and uniform"},
    Lesson{"knots", "grid", "knots along | round K ...",
           "Those along the yarn, clamped; those round it go with `open round`.", "knots along 0 0 0 1 1 1",
           "", "clamped and uniform"},
    Lesson{"degree", "grid", "degree N along | round", "From 1 to 25.", "degree 2 along", "",
           "3 along, 2 round"},
    Lesson{"open", "grid", "open round",
           "The rows are the clamped form of each section: the seam's point stands first and last.",
           "open round"},
    Lesson{"corners", "grid", "corners U1 U2 U3 U4",
           "Where the end patches have their corners, by the knots round.", "corners 0 1 2 3", "",
           "where the outline has turned by quarters"},
    Lesson{"centre", "grid", "centre start | end X Y Z", "Where the rows of a fan meet that seals this end.",
           "centre start 0 6.1 0", "length", "the middle of the section"},
    Lesson{"closed", "grid", "closed", "A ring; with `knots along` the last section is the first again.",
           "closed"},

    // --- weave
    Lesson{"warp", "weave", "warp THREADS N [pitch] P [open]",
           "The warps: threads in turn (`a,2b`), how many, and how far apart; `open` where that is more than "
           "20 times "
           "their width. `24 per cm` is 24/cm.",
           "warp cotton 8 24/cm", "pitch"},
    Lesson{"weft", "weave", "weft THREADS N [pitch] P [open]",
           "The wefts: threads in turn (`a,2b`), how many, and how far apart; `open` where that is more than "
           "20 times "
           "their width. `24 per cm` is 24/cm.",
           "weft cotton 8 pitch 0.4", "pitch"},
    Lesson{"fill", "weave", "fill THREADS N [pitch] P [open]", "Another word for weft. `24 per cm` is 24/cm.",
           "fill cotton 8 60 ppi", "pitch"},
    Lesson{
        "draft", "weave",
        "draft plain | twill A/B[/...] [Z | S] | satin N[/STEP] [weft-faced | warp-faced] | basket "
        "ENDSxPICKS | corduroy [ENDS] | velveteen [ENDS] | "
        "basket A/B | oxford | sateen N | drill | 5HS | leno "
        "[half | full] | file NAME",
        "Which yarn is on top; without a word a block of rows of 0 and 1 (1: warp on top) that `end` closes. "
        "A number of shafts with HS, H or harness behind it (`5HS`, `8-harness`) is a satin.",
        "draft twill 2/2"},
    Lesson{"profile", "weave", "profile peirce | sine [A] | lenticular | racetrack | straight",
           "How yarns go between crossings on different sides.", "profile sine 0.12", "length",
           "by the sections that are crossed; dense yarns press each other flat"},
    Lesson{"crimp", "weave", "crimp S", "The warp's share of the crimp, 0 to 1.", "crimp 0.4", "",
           "half, or what there is room for"},
    Lesson{"spacing", "weave", "spacing even | relaxed",
           "Whether yarns come together under floats and apart at intersections.", "spacing relaxed", "",
           "even"},
    Lesson{"state", "weave", "state loom | relaxed | finished",
           "The cloth in equilibrium: loom under the tensions of weaving, relaxed under little tension, "
           "finished under equal tensions in both systems. See `selvage explain equilibrium`.",
           "state finished", "", "finished; with a profile none: its formula gives paths and sections"},
    Lesson{
        "pucker", "weave", "pucker tight T slack S ratio R every N",
        "A seersucker: S slack warps after T tight ones, R times as long, in waves of N picks; 1 < R <= 2.",
        "pucker tight 3 slack 6 ratio 1.08 every 12"},
    Lesson{"thickness", "weave", "thickness T", "Yarns are pressed until the cloth is no thicker than T.",
           "thickness 0.18", "length"},
    Lesson{"fraction", "weave", "fraction F",
           "Plates press the cloth, each of its layers alike, until fibres fill F of it; 0 < F < 0.907.",
           "fraction 0.55", "", "as much as they fill by themselves"},
    Lesson{"compact", "weave", "compact P [MPa]",
           "Plates press the cloth, each of its layers alike, with this pressure, MPa. Its threads have "
           "filaments, a "
           "linear density, and a material with an elastic modulus.",
           "compact 0.1"},
    Lesson{
        "layers", "weave", "layers N",
        "N cloths on each other; with `profile straight` N layers of warps, with `levels` N layers of wefts.",
        "layers 2", "", "1"},
    Lesson{
        "levels", "weave", "levels [THREAD] L ... [, [THREAD] L ...]",
        "The warps above each other in a column, from the lowest, with L layers of weft below each at weft "
        "1, 2, ...; a line for each column, in turn. In the place of a draft.",
        "levels 1 0 1 0 , 2 1 2 1"},
    Lesson{"binder", "weave", "binder THREAD every K [first G] levels L ...",
           "Binders in every K-th gap between warps, with L layers of weft below them at weft 1, 2, ...",
           "binder z every 2 levels 3 0"},
    Lesson{
        "pile", "weave", "pile H [THREAD] [every N] [face | back | both] [cut]",
        "An end of pile beside each end of the warp, in terry loops that stand H out of the ground every N "
        "picks; cut: a velvet.",
        "pile 3", "length", "3 picks, both sides; of a cut pile the face"},

    // --- knit
    Lesson{"thread", "knit", "thread THREADS", "The threads that the rows of the chart take in turn.",
           "thread cotton"},
    Lesson{"courses", "knit", "courses N [[pitch] P]", "How many courses, and how far apart.",
           "courses 6 18/cm", "pitch", "7 times half the diameter"},
    Lesson{"wales", "knit", "wales N [[pitch] P]", "How many wales, and how far apart.", "wales 6 13/cm",
           "pitch", "8 times half the diameter"},
    Lesson{"loop", "knit", "loop L", "Length of yarn of a stitch, the mean over a repeat of the chart.",
           "loop 2.8", "length", "that of the published loop"},
    Lesson{"stitch", "knit", "stitch length L", "Another word for loop.", "stitch length 2.8", "length",
           "that of the published loop"},
    Lesson{"feeds", "knit", "feeds N", "So many rows of the chart, and yarns, make a course.", "feeds 3", "",
           "1"},
    Lesson{"gating", "knit", "gating rib | opposite [D]",
           "How the needles of both beds stand; D: the distance of their loops' middle planes.",
           "gating opposite 2", "length", "rib"},
    Lesson{"plating", "knit", "plating THREAD", "A second yarn with each course, behind it.",
           "plating lycra"},
    Lesson{"pile", "knit", "pile H [cut]",
           "The plating yarn's sinkers stand out H beyond the back, as terry loops.", "pile 1.5", "length"},
    Lesson{"unit", "knit", "unit R", "The r of the published loop, instead of the pitches.", "unit 0.13",
           "length", "half the diameter"},
    Lesson{"crossing", "knit", "crossing X Y Z", "Where both yarns cross at the foot of the first loop.",
           "crossing 1 0.5 0.25", "length", "x half a wale, y = z = 0"},
    Lesson{"shape", "knit", "shape published | relaxed",
           "The published loop, or that of least bending energy for its courses, wales and length.",
           "shape relaxed", "", "published"},
    Lesson{"points", "knit", "points [K | P | T | U | M] ... end",
           "A loop of one's own for a sign of the chart: rows `x y z` in wales, courses, thicknesses.",
           "points", "", "K"},
    Lesson{"method", "knit", "method uniform | chord | centripetal",
           "The parameters of the loop's centre line.", "method chord", "", "chord"},
    Lesson{"chart", "knit", "chart ... end",
           "Rows of signs, the bottom row is course 1: K, P, T, M, U and `.`; of a jacquard 1 to 6.",
           "chart"},
    Lesson{"transfer", "knit", "transfer ROW WALE right | left N",
           "The loop of that row (1: the bottom one) and wale of the chart goes to the needle N wales on. Of "
           "loops "
           "that cross or meet the one above in the text lies before, on the face.",
           "transfer 2 3 right 1"},
    Lesson{"drop", "knit", "drop ROW WALE", "The loop of that row and wale of the chart is let go.",
           "drop 2 3"},

    // --- warpknit
    Lesson{"thread", "warpknit braid", "thread NAME", "The thread of its yarns.", "thread pet"},
    Lesson{"bar", "warpknit", "bar THREAD LAPPING [fall-plate]",
           "A guide bar, the front one first; its overlaps A-B, one a course.", "bar pet 1-0/1-2//"},
    Lesson{"points", "warpknit", "points ... end",
           "The loop of the bar above it, 4 to 11 rows `x y z` in wales, courses, thicknesses.", "points"},
    Lesson{"weft", "warpknit", "weft THREADS every N [first C]",
           "Straight yarns from edge to edge, in course C and every N-th from there.",
           "weft pet every 2 first 1", "", "first 1"},
    Lesson{"wales", "warpknit", "wales N pitch P", "Guides of every bar, and how far needles are apart.",
           "wales 4 pitch 0.9", "pitch"},
    Lesson{"courses", "warpknit", "courses N pitch P", "How many courses, and how far apart.",
           "courses 6 pitch 0.6", "pitch"},
    Lesson{"stitch", "warpknit", "stitch closed | open", "Of a warp knit by name: how its laps are.",
           "stitch open", "", "closed"},
    Lesson{"substrate", "warpknit", "substrate H",
           "Room between underlaps and loops, for layers that the knit stitches together.", "substrate 0.6",
           "length"},

    // --- braid
    Lesson{"carriers", "braid", "carriers N", "How many braiders; an even number but of a strip.",
           "carriers 16"},
    Lesson{"pattern", "braid", "pattern A/B", "Over A, under B: 1/1 diamond, 2/2 regular, 3/3 hercules.",
           "pattern 2/2"},
    Lesson{"radius", "braid", "radius R", "Of a tube's middle surface.", "radius 5", "length"},
    Lesson{"planar", "braid", "planar [W]",
           "A tube's cloth laid flat, W wide, which repeats along both sides.", "planar 8.8", "length",
           "as narrow as its yarns can be"},
    Lesson{"flat", "braid", "flat [W]", "A strip, W wide, instead of a tube.", "flat", "length",
           "as wide as the yarns need"},
    Lesson{"mandrel", "braid", "mandrel ... end",
           "The axis and the radius along it, instead of radius and length: rows `x y z R`, at least 2.",
           "mandrel", "length"},
    Lesson{"angle", "braid", "angle A", "Between yarn and axis, above 0 and below 90 degrees.", "angle 45",
           "angle"},
    Lesson{"length", "braid", "length L", "Along the axis of a tube, a strip or a planar braid.", "length 20",
           "length"},
    Lesson{"axial", "braid", "axial THREAD N", "N straight yarns in the middle surface.", "axial rod 4"},

    // --- piece
    Lesson{
        "curve", "piece",
        "curve NAME [C | S | control | spline] [by uniform | chord | distance | centripetal] ... end",
        "A cubic near its rows `x y`, at least 3; `spline` goes through all, `control` has control points.",
        "curve neck spline", "length"},
    Lesson{"line", "piece", "line NAME X Y  X Y", "A straight part of the outline.", "line hem 0 0  6 0",
           "length"},
    Lesson{
        "edit", "piece",
        "edit CURVE point K to X Y | weight K to X Y | length L | of PIECE CURVES [ease E] point K along X Y",
        "Moves the K-th joint of a curve that is a B-spline.", "edit neck point 3 to 2 4.9", "length"},

    // --- use
    Lesson{"repeat", "use", "repeat NX NY [step SX SY]",
           "Copies side by side, along the block's own x and y.", "repeat 1 8 step 0 3", "pitch",
           "1 1; steps of the block's own repeat"},
    Lesson{"place", "use", "place X Y Z", "Moves by so much.", "place 0 0 0.4", "length"},
    Lesson{"rotate", "use", "rotate [x | y | z] ANGLE", "Turns about an axis through the origin.",
           "rotate 90", "angle", "z"},
    Lesson{"mirror", "use", "mirror x | y | z", "This coordinate changes its sign, and twists their hand.",
           "mirror z"},
    Lesson{"shear", "use", "shear [A B] ANGLE",
           "Moves along axis A (x, y or z) by tan(ANGLE) times the distance along B, at most 80 degrees.",
           "shear y x 45", "angle", "x y"},

    // --- cell
    Lesson{"matrix", "cell", "matrix MATERIAL", "What fills the cell where no yarn is.", "matrix epoxy"},
    Lesson{"periodic", "cell", "periodic x | y | z ...", "Axes whose opposite faces get the same mesh.",
           "periodic x y", "", "the axes along which the cloth repeats"},
    Lesson{"margin", "cell", "margin M", "Of a cell as high as its yarns: above and below them.",
           "margin 0.05", "length", "a tenth of the thinnest yarn's thickness"},

    Lesson{"end", "every", "end", "Closes the block that is open.", "end"},
};

}  // namespace

std::span<const Lesson> all_lessons() {
  return lessons;
}

}  // namespace selvage::formats::txt
