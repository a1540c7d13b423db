#include "formats/foam/settings.h"

namespace selvage::formats::foam {

const std::string_view control = R"(application     simpleFoam;
startFrom       latestTime;
startTime       0;
stopAt          endTime;
endTime         1000;
deltaT          1;
writeControl    timeStep;
writeInterval   1000;
purgeWrite      1;
writeFormat     ascii;
writePrecision  10;
runTimeModifiable false;
)";

const std::string_view schemes = R"(ddtSchemes           { default steadyState; }
gradSchemes          { default Gauss linear; }
divSchemes
{
    default          none;
    div(phi,U)       bounded Gauss linear;
    div((nuEff*dev2(T(grad(U))))) Gauss linear;
}
laplacianSchemes     { default Gauss linear limited 0.5; }
interpolationSchemes { default linear; }
snGradSchemes        { default limited 0.5; }
)";

const std::string_view solution = R"(solvers
{
    p { solver PCG; preconditioner DIC; tolerance 1e-14; relTol 0.01; }
    U { solver smoothSolver; smoother symGaussSeidel; tolerance 1e-14; relTol 0.05; }
}
SIMPLE
{
    nNonOrthogonalCorrectors 1;
    consistent yes;
    pRefCell 0;
    pRefValue 0;
    residualControl { U 1e-6; }
}
relaxationFactors { equations { U 0.9; } }
)";

}  // namespace selvage::formats::foam
