// The critical speed in words.

import { say } from './words.js';

export function fitText(report) {
  const { omega_crit_rpm: speed, interval_rpm: ends, decimals } = report;
  if (speed === undefined) return report.why;
  const [low, high] = ends.map((end) => (end === null ? say('unbounded') : end.toFixed(decimals)));
  return [
    say('ω_crit = {speed} RPM, 95 % interval {low} to {high} RPM', { speed: speed.toFixed(decimals), low, high }),
    ...(report.inverse_rpm === null ? [] : [say('the line alone: {speed} RPM', { speed: report.inverse_rpm.toFixed(1) })]),
    ...report.warnings,
  ].join('; ');
}
