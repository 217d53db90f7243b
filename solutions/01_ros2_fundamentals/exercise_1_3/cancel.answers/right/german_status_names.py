"""Right: German log lines, a table of status names, cancels at the fourth feedback."""
import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node

NAMEN = {
    value: name.removeprefix('STATUS_')
    for name, value in GoalStatus.__prepare__(None, None).items()
    if name.startswith('STATUS_')
}


class Abbrecher(Node):
    GENUG = 4

    def __init__(self):
        super().__init__('abbrecher')
        self.kunde = ActionClient(self, Fibonacci, 'fibonacci')
        self.griff = None
        self.meldungen = 0
        self.fertig = False

    def los(self):
        ziel = Fibonacci.Goal()
        ziel.order = 20
        self.kunde.send_goal_async(ziel, self.rückmeldung).add_done_callback(self.antwort)

    def antwort(self, zukunft):
        self.griff = zukunft.result()
        if not self.griff.accepted:
            self.get_logger().error('🚫 Der Server nimmt das Ziel nicht an: REJECTED.')
            self.fertig = True
            return
        self.griff.get_result_async().add_done_callback(self.ende)

    def rückmeldung(self, meldung):
        self.meldungen += 1
        self.get_logger().info(f'🔢 {self.meldungen}. Rückmeldung: {meldung.feedback.partial_sequence.tolist()}')
        if self.meldungen == self.GENUG:
            self.get_logger().info('✋ Es reicht, ich breche ab.')
            self.griff.cancel_goal_async()

    def ende(self, zukunft):
        self.get_logger().info(f'🏁 Endzustand: {NAMEN[zukunft.result().status]}')
        self.fertig = True


def main():
    rclpy.init()
    knoten = Abbrecher()
    if not knoten.kunde.wait_for_server(timeout_sec=10):
        print('Kein Server da (not available).')
        return
    knoten.los()
    while not knoten.fertig:
        rclpy.spin_once(knoten, timeout_sec=0.1)
    knoten.destroy_node()


if __name__ == '__main__':
    main()
