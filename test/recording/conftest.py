import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # for mutations.py and bag_of_a_made_up_run.py
