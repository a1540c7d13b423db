// gmsh (from 4.8) fills a unit cell that `selvage convert --matrix` wrote, conformally:
//   gmsh -save -clmax 0.2 cell.geo      beside cell.stp; 0.2: edges at most so long, mm
// A STEP file cannot say that two solids share a face: each has its own copy of it. Here copies, which have
// one area and one centre, get one mesh, and nodes that are one place become one.
SetFactory("OpenCASCADE");
v() = ShapeFromFile("cell.stp");
s() = Surface{:};
For i In {0:#s()-1}
  m() = Mass Surface{s(i)};
  c() = CenterOfMass Surface{s(i)};
  area(i) = m(0); x(i) = c(0); y(i) = c(1); z(i) = c(2);
  For k In {0:i-1}
    near = 1e-6 * Sqrt(area(i));
    If (Fabs(area(k) - area(i)) < near * Sqrt(area(i)) && Fabs(x(k) - x(i)) < near &&
        Fabs(y(k) - y(i)) < near && Fabs(z(k) - z(i)) < near)
      Periodic Surface{s(i)} = {s(k)} Translate{0, 0, 0};
    EndIf
  EndFor
EndFor
Geometry.OCCUseGenericClosestPoint = 1;  // a tenth of the time; places within 1e-5
Mesh 3;
Geometry.Tolerance = 1e-5;  // of the cell's size
Coherence Mesh;
