"""Feeds PyTorch: recovers the roughness of a sphere's surface from its picture, under a panorama's light.

    python3 torch_lighting.py [ENVIRONMENT.exr]

octagloss bakes the reflections of every direction at a few roughnesses; PyTorch interpolates between them and
follows the gradient. Needs torch (Debian: python3-torch, or PyPI's), on the CPU.
"""

import sys
from pathlib import Path
from typing import Tuple

import numpy as np
import torch
from numpy.typing import NDArray

import octagloss

SIZE = 64
LEVELS = 9
DEFAULT = Path(__file__).resolve().parents[2] / "hdr" / "studio.hdr"


def sphere() -> Tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Which pixels of a picture show the unit sphere, seen along -Z, and what direction each reflects."""
    steps = (np.arange(SIZE) + 0.5) / SIZE * 2 - 1
    x, y = np.meshgrid(steps, -steps)
    z2 = 1 - x * x - y * y
    seen = z2 > 0
    normals = np.stack([x[seen], y[seen], np.sqrt(z2[seen])], axis=-1)
    view = np.array([0.0, 0.0, 1.0])
    return seen, 2 * normals[:, 2:] * normals - view


def main() -> None:
    environment = octagloss.Environment.from_file(sys.argv[1] if len(sys.argv) > 1 else DEFAULT)
    seen, reflected = sphere()

    # A table of each pixel's reflection at nine roughnesses: arrays of NumPy become tensors without a copy.
    ladder = np.linspace(0.1, 0.9, LEVELS)
    table = environment.reflect(reflected[:, None], ladder)
    reflections = torch.from_numpy(table)  # (pixels, LEVELS, 3)

    # The picture to explain: roughness 0.2 on the left, 0.7 on the right. Its reflections are exact, not
    # those of the table.
    columns = np.nonzero(seen)[1] / SIZE
    truth = torch.from_numpy(0.2 + 0.5 * columns)
    picture = torch.from_numpy(environment.reflect(reflected, truth.numpy(), sharpest=0.1))

    # Roughness by column, as a straight line of two unknowns.
    ends = torch.tensor([0.5, 0.5], dtype=torch.float64, requires_grad=True)
    along = torch.from_numpy(columns)
    optimizer = torch.optim.Adam([ends], lr=0.02)

    def shade(roughness: torch.Tensor) -> torch.Tensor:
        place = ((roughness - 0.1) / 0.8 * (LEVELS - 1)).clamp(0, LEVELS - 1 - 1e-6)
        low = place.detach().floor().long()
        share = (place - low).unsqueeze(-1)
        pixels = torch.arange(len(place))
        return reflections[pixels, low] * (1 - share) + reflections[pixels, low + 1] * share

    loss = torch.tensor(0.0)
    for _ in range(200):
        optimizer.zero_grad()
        roughness = ends[0] + (ends[1] - ends[0]) * along
        loss = (torch.log1p(shade(roughness)) - torch.log1p(picture)).square().mean()
        loss.backward()  # type: ignore[no-untyped-call, unused-ignore]
        optimizer.step()

    left, right = ends.tolist()
    print(f"roughness {left:.3f} to {right:.3f}, was 0.200 to 0.700; loss {loss.item():.2e}")
    worst = max(abs(left - 0.2), abs(right - 0.7))
    if worst > 0.03:
        sys.exit(f"off by {worst:.3f}")


if __name__ == "__main__":
    main()
