import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # for truth.py and laboratory.py, which several tests share
